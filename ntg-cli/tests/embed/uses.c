/*
 * Uses the library of cart.ntg rightly and wrongly. Prints the bits of what it reads after every good solve, and at the end
 * how often memory was asked for after create. Ends with the number of the line at which something is not as it should be.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "cart.h"
#include "counting.h"

#define EXPECT(holds)                                                            \
    do {                                                                         \
        if (!(holds)) {                                                          \
            fprintf(stderr, "line %d: %s\n", __LINE__, cart_message(solver));    \
            return 1;                                                            \
        }                                                                        \
    } while (0)

/* Whether a reading is what it was, to the last bit. */
static int same(cart_solver *solver, double wanted) {
    double value = NAN;
    return cart_read(solver, CART_speed, 0, 0.9, &value) == CART_OK && memcmp(&value, &wanted, sizeof value) == 0;
}

int main(void) {
    cart_parameters parameters = CART_DEFAULTS, wrong;
    cart_solver *solver = NULL, *second = (cart_solver *)&parameters;
    cart_numbers numbers;
    double value = 7.0, speed = 0.0;
    uint64_t bits;
    long before;
    int k, j, status;
    /* The C library would allocate a buffer for what is printed. */
    static char buffer[1 << 14];
    setvbuf(stdout, buffer, _IOFBF, sizeof buffer);

    EXPECT(cart_create(&parameters, NULL) == CART_NULL_ARGUMENT);
    wrong = parameters;
    wrong.v_max = 0.1;
    EXPECT(cart_create(&wrong, &second) == CART_INFEASIBLE && second == NULL);
    EXPECT(strstr(cart_message(NULL), "slow") != NULL);
    wrong.reach[1] = NAN;
    EXPECT(cart_create(&wrong, &second) == CART_BAD_PARAMETER && second == NULL);
    EXPECT(strstr(cart_message(NULL), "reach[2]") != NULL);
    EXPECT(cart_create(NULL, &second) == CART_OK);
    EXPECT(cart_create(&parameters, &solver) == CART_OK);

    before = allocations();
    for (k = 0; k < 40; ++k) {
        parameters.p0 = 1.5 * k;
        parameters.v0 = 40.0 - k;
        EXPECT(cart_set(solver, &parameters) == CART_OK);
        EXPECT(cart_solve(solver, 50, 5.0) == CART_OK);
        EXPECT(cart_read(solver, CART_speed, 0, 0.9, &speed) == CART_OK);
        for (j = 0; j < 3; ++j) {
            EXPECT(cart_read(solver, CART_p, j, 0.9, &value) == CART_OK);
            memcpy(&bits, &value, sizeof bits);
            printf("%016llx ", (unsigned long long)bits);
        }
        memcpy(&bits, &speed, sizeof bits);
        printf("%016llx\n", (unsigned long long)bits);

        /* A state that is no number. */
        wrong = parameters;
        wrong.p0 = NAN;
        EXPECT(cart_set(solver, &wrong) == CART_BAD_PARAMETER && strstr(cart_message(solver), "`p0`") != NULL);
        /* Bounds that cross. */
        wrong = parameters;
        wrong.v_max = -1.0;
        EXPECT(cart_set(solver, &wrong) == CART_OK && cart_solve(solver, 0, 0.0) == CART_BAD_PARAMETER);
        EXPECT(strstr(cart_message(solver), "slow") != NULL);
        /* No way to get there in time; a limit may be reached before that is known. */
        wrong.v_max = 0.45;
        wrong.reach[0] = 200.0;
        EXPECT(cart_set(solver, &wrong) == CART_OK);
        status = cart_solve(solver, 100, 0.0);
        EXPECT(status == CART_INFEASIBLE || status == CART_ITERATION_LIMIT);
        EXPECT(strlen(cart_message(solver)) > 20);
        EXPECT(cart_info(solver, &numbers) == CART_OK && numbers.status == status);
        /* Limits. */
        wrong = parameters;
        wrong.reach[0] = 30.0;
        EXPECT(cart_set(solver, &wrong) == CART_OK);
        EXPECT(cart_solve(solver, 1, 0.0) == CART_ITERATION_LIMIT);
        EXPECT(cart_solve(solver, 0, 1e-12) == CART_TIME_LIMIT);
        EXPECT(cart_solve(solver, -1, 0.0) == CART_BAD_ARGUMENT);
        EXPECT(cart_solve(solver, 0, NAN) == CART_BAD_ARGUMENT);
        /* Readings that are none. */
        value = 7.0;
        EXPECT(cart_read(solver, CART_READINGS, 0, 0.0, &value) == CART_BAD_ARGUMENT && value == 7.0);
        EXPECT(cart_read(solver, CART_speed, 1, 0.0, &value) == CART_BAD_ARGUMENT);
        EXPECT(cart_read(solver, CART_p, 0, NAN, &value) == CART_BAD_ARGUMENT);
        EXPECT(cart_read(NULL, CART_p, 0, 0.0, &value) == CART_NULL_ARGUMENT);
        EXPECT(same(solver, speed));
    }
    EXPECT(cart_reset(solver) == CART_OK && cart_info(solver, &numbers) == CART_OK);
    EXPECT(numbers.helped_out == 0.0 && numbers.start == 0.0 && numbers.end == 2.0);
    printf("allocations %ld\n", allocations() - before);
    cart_destroy(solver);
    cart_destroy(second);
    cart_destroy(NULL);
    return 0;
}
