/*
 * Flies specs/low_observable.ntg in a closed loop: in every step the position is measured, a plan to the target is made from
 * there, and the aircraft flies as the plan begins, moved by wind. Flights follow each other, from other places, until the
 * steps are made.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "low_observable.h"
#include "steps.h"

/* Seconds of a step. */
#define STEP 0.6
/* The strongest wind, in km/s; the position is measured as well, with an error in km. */
#define WIND 2e-3
#define ERROR 5e-3
/* Nearer than this to the target a flight ends, in km: a plan takes at least 100 s, so it would circle. */
#define NEAR 30.0

int main(int words, char **word) {
    const long wanted = words > 1 ? strtol(word[1], NULL, 10) : 10000;
    low_observable_parameters parameters = LOW_OBSERVABLE_DEFAULTS;
    low_observable_solver *solver = NULL;
    low_observable_numbers numbers;
    uint64_t random = 88172645463325252u;
    double x = parameters.x_start, y = parameters.y_start, wind[2] = {0.0, 0.0}, began = now();
    long k, flights = 1, failed;
    steps all;
    int status = low_observable_create(&parameters, &solver);
    if (status > LOW_OBSERVABLE_ACCEPTABLE || !steps_begin(&all, wanted)) {
        fprintf(stderr, "%s\n", low_observable_message(NULL));
        return 1;
    }
    all.first = now() - began;

    for (k = 0; k < wanted; ++k) {
        double east = 0.0, north = 0.0;
        low_observable_info(solver, &numbers);
        low_observable_read(solver, LOW_OBSERVABLE_x, 1, numbers.start, &east);
        low_observable_read(solver, LOW_OBSERVABLE_y, 1, numbers.start, &north);
        wind[0] = 0.99 * wind[0] + 0.01 * WIND * noise(&random);
        wind[1] = 0.99 * wind[1] + 0.01 * WIND * noise(&random);
        x += STEP * (east + wind[0]);
        y += STEP * (north + wind[1]);
        if (hypot(x - parameters.x_target, y - parameters.y_target) < NEAR) {
            x = -100.0 + 3.0 * noise(&random);
            y = -100.0 + 3.0 * noise(&random);
            low_observable_reset(solver);
            ++flights;
        }
        parameters.x_start = x + ERROR * noise(&random);
        parameters.y_start = y + ERROR * noise(&random);

        began = now();
        status = low_observable_set(solver, &parameters);
        if (status == LOW_OBSERVABLE_OK) status = low_observable_solve(solver, 0, 0.0);
        low_observable_info(solver, &numbers);
        steps_add(&all, status, numbers.iterations, now() - began);
        if (status > LOW_OBSERVABLE_ACCEPTABLE) {
            fprintf(stderr, "step %ld of flight %ld at (%.3f, %.3f): %s\n", k, flights, x, y,
                    low_observable_message(solver));
        }
    }
    printf("%ld flights; memory reserved by create: %.1f MB, of it used %.1f MB; blocks allocated after it: %.0f\n",
           flights, 1e-6 * numbers.reserved, 1e-6 * numbers.used, numbers.helped_out);
    failed = steps_say(&all, low_observable_text);
    low_observable_destroy(solver);
    return failed > 0;
}
