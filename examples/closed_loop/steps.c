/* What is said of many steps: see steps.h. */
#define _POSIX_C_SOURCE 199309L
#include "steps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Bins of the histogram of times: each is so many times as wide as the one before. */
#define RATIO 1.25
/* Characters of the longest bar. */
#define BAR 50

double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

double noise(uint64_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) / 4503599627370496.0 - 1.0;
}

int steps_begin(steps *all, long room) {
    int i;
    for (i = 0; i < STATUSES; ++i) all->statuses[i] = 0;
    all->count = 0;
    all->room = room;
    all->first = 0.0;
    all->seconds = malloc((size_t)room * sizeof *all->seconds);
    all->iterations = malloc((size_t)room * sizeof *all->iterations);
    return all->seconds != NULL && all->iterations != NULL;
}

void steps_add(steps *all, int status, int iterations, double seconds) {
    if (status >= 0 && status < STATUSES) ++all->statuses[status];
    if (all->count == all->room) return;
    all->seconds[all->count] = seconds;
    all->iterations[all->count++] = iterations;
}

static int by_size(const void *a, const void *b) {
    const double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

static void bar(long count, long most) {
    long i;
    for (i = 0; i < (count * BAR + most - 1) / most; ++i) putchar('#');
    printf(" %ld\n", count);
}

static void say_iterations(const steps *all) {
    long counts[1000] = {0}, i, most = 0;
    int worst = 0;
    for (i = 0; i < all->count; ++i) {
        const int n = all->iterations[i] < 999 ? all->iterations[i] : 999;
        if (++counts[n] > most) most = counts[n];
        if (all->iterations[i] > worst) worst = all->iterations[i];
    }
    printf("iterations of a step (worst %d)\n", worst);
    for (i = 0; i < 1000; ++i) {
        if (counts[i] > 0) {
            printf("  %9ld  ", i);
            bar(counts[i], most);
        }
    }
}

/* Takes times in order. */
static void say_times(const steps *all) {
    const double *times = all->seconds;
    const double least = times[0] / all->first;
    long i = 0, most = 1, begin;
    int pass;
    printf("processor time of a step, with create as 1: median %.4f, 99 %% %.4f, 99.9 %% %.4f, worst %.4f\n",
           times[all->count / 2] / all->first, times[all->count * 99 / 100] / all->first,
           times[all->count * 999 / 1000] / all->first, times[all->count - 1] / all->first);
    for (pass = 0; pass < 2; ++pass) {
        double edge = least * RATIO;
        for (i = 0; i < all->count; edge *= RATIO) {
            begin = i;
            while (i < all->count && times[i] / all->first <= edge) ++i;
            if (i - begin > most) most = i - begin;
            if (pass == 1 && i > begin) {
                printf("  <= %6.4f  ", edge);
                bar(i - begin, most);
            }
        }
    }
}

long steps_say(steps *all, const char *(*text)(int)) {
    long failed = 0;
    int status;
    printf("%ld steps\n", all->count);
    for (status = 0; status < STATUSES; ++status) {
        if (all->statuses[status] > 0) printf("  %9ld  %s\n", all->statuses[status], text(status));
        if (status > 1) failed += all->statuses[status];
    }
    if (all->count > 0) {
        say_iterations(all);
        qsort(all->seconds, (size_t)all->count, sizeof *all->seconds, by_size);
        say_times(all);
    }
    free(all->seconds);
    free(all->iterations);
    return failed;
}
