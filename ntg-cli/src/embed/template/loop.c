/*
 * A closed loop in C: the state is measured, a plan is made from it, and the input is read from the plan.
 *
 * Here the plant is the plan itself: after every step the state is where the plan says it is. Prints one line a step: the
 * status, the iterations, and all functions of time at the beginning of the plan, to the last bit (as C99 writes them).
 *
 *   loop [STEPS [SECONDS]]       10 steps, each a hundredth of the first plan
 */
#include <stdio.h>
#include <stdlib.h>

#include "@NAME@.h"

static int fail(@NAME@_solver *solver, int status) {
    fprintf(stderr, "%s: %s\n", @NAME@_text(status), @NAME@_message(solver));
    @NAME@_destroy(solver);
    return 1;
}

int main(int words, char **word) {
    static const int shown[] = {@SHOWN@};
    @NAME@_parameters parameters = @UPPER@_DEFAULTS;
    @NAME@_solver *solver = NULL;
    @NAME@_numbers numbers;
    const long steps = words > 1 ? strtol(word[1], NULL, 10) : 10;
    double step;
    long k;
    int status = @NAME@_create(&parameters, &solver);
    if (status > @UPPER@_ACCEPTABLE) return fail(solver, status);
    status = @NAME@_info(solver, &numbers);
    if (status != @UPPER@_OK) return fail(solver, status);
    step = words > 2 ? strtod(word[2], NULL) : 0.01 * (numbers.end - numbers.start);

    for (k = 0; k <= steps; ++k) {
        size_t i;
        printf("%ld %d %d", k, numbers.status, numbers.iterations);
        for (i = 0; i < sizeof shown / sizeof shown[0]; ++i) {
            double value = 0.0;
            status = @NAME@_read(solver, shown[i], 0, numbers.start, &value);
            if (status != @UPPER@_OK) return fail(solver, status);
            printf(" %a", value);
        }
        printf("\n");
        if (k == steps) break;

        /* What is measured a step later. */
@MEASURE@
        status = @NAME@_set(solver, &parameters);
        if (status != @UPPER@_OK) return fail(solver, status);
        status = @NAME@_solve(solver, 100, 1.0);
        if (status > @UPPER@_ACCEPTABLE) return fail(solver, status);
        status = @NAME@_info(solver, &numbers);
        if (status != @UPPER@_OK) return fail(solver, status);
    }
    @NAME@_destroy(solver);
    return 0;
}
