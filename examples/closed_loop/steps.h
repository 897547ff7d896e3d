/* What the closed loops of this folder share: a clock, random numbers, and what is said of many steps. */
#ifndef STEPS_H
#define STEPS_H

#include <stdint.h>

/* Statuses are below this number, in every header that `ntg embed` writes. */
#define STATUSES 16

/* What is remembered of every step. */
typedef struct steps {
    /* Seconds of create: the first plan, and what is kept from it. */
    double first;
    long count, room;
    double *seconds;
    int *iterations;
    long statuses[STATUSES];
} steps;

/* Seconds that the processor has worked for this thread: what else runs on the machine does not count. */
double now(void);

/* A number between -1 and 1, the same in every run (Marsaglia, xorshift). */
double noise(uint64_t *state);

/* Room for so many steps; 0 where there is no memory. */
int steps_begin(steps *all, long room);

void steps_add(steps *all, int status, int iterations, double seconds);

/* Prints how the steps ended, their iterations, and their times in units of create's; how many failed. */
long steps_say(steps *all, const char *(*text)(int));

#endif
