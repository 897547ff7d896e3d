/*
 * Balances the cart-pole of cart_pole.ntg in a closed loop: in every step place, angle and rates are measured, the force is
 * planned over the horizon, and the motor holds its first value. Somebody pushes the pole and moves the goal.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cart_pole.h"
#include "steps.h"

/* Seconds of a step, and into how many parts the plant's is cut. */
#define STEP 0.02
#define PARTS 4
#define PI 3.14159265358979323846

/* The plant: the equations of the spec, solved for the accelerations. State: p, v, phi, w. */
static void slopes(const cart_pole_parameters *of, const double s[4], double force, double out[4]) {
    const double ml = of->m_pole * of->length, c = cos(s[2]), n = sin(s[2]);
    const double mass = of->m_cart + of->m_pole - of->m_pole * c * c;
    out[0] = s[1];
    out[1] = (force + ml * s[3] * s[3] * n - of->m_pole * 9.81 * n * c) / mass;
    out[2] = s[3];
    out[3] = (9.81 * n - out[1] * c) / of->length;
}

/* One step of Runge and Kutta's classical method. */
static void advance(const cart_pole_parameters *of, double s[4], double force, double h) {
    double k[4][4], at[4];
    const double part[3] = {0.5, 0.5, 1.0};
    int i, j;
    for (j = 0; j < 4; ++j) {
        for (i = 0; i < 4; ++i) at[i] = s[i] + (j > 0 ? part[j - 1] * h * k[j - 1][i] : 0.0);
        slopes(of, at, force, k[j]);
    }
    for (i = 0; i < 4; ++i) s[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
}

int main(int words, char **word) {
    const long wanted = words > 1 ? strtol(word[1], NULL, 10) : 10000;
    cart_pole_parameters parameters = CART_POLE_DEFAULTS;
    cart_pole_solver *solver = NULL;
    cart_pole_numbers numbers;
    uint64_t random = 88172645463325252u;
    double s[4], began = now(), tilt = 0.0;
    long k, failed;
    steps all;
    int i, status = cart_pole_create(&parameters, &solver);
    if (status > CART_POLE_ACCEPTABLE || !steps_begin(&all, wanted)) {
        fprintf(stderr, "%s\n", cart_pole_message(NULL));
        return 1;
    }
    all.first = now() - began;
    s[0] = parameters.p0, s[1] = parameters.v0, s[2] = parameters.phi0 * PI / 180.0, s[3] = parameters.w0;

    for (k = 0; k < wanted; ++k) {
        double force = 0.0;
        cart_pole_info(solver, &numbers);
        cart_pole_read(solver, CART_POLE_force, 0, numbers.start, &force);
        for (i = 0; i < PARTS; ++i) advance(&parameters, s, force + 0.3 * noise(&random), STEP / PARTS);
        if (k % 250 == 100) s[3] += 1.5 * noise(&random);
        if (k % 1000 == 500) parameters.goal = 0.5 * noise(&random);
        if (fabs(s[2]) > tilt) tilt = fabs(s[2]);
        parameters.p0 = s[0] + 1e-4 * noise(&random);
        parameters.v0 = s[1] + 1e-3 * noise(&random);
        parameters.phi0 = 180.0 / PI * s[2] + 1e-2 * noise(&random);
        parameters.w0 = s[3] + 1e-3 * noise(&random);

        began = now();
        status = cart_pole_set(solver, &parameters);
        if (status == CART_POLE_OK) status = cart_pole_solve(solver, 0, 0.0);
        cart_pole_info(solver, &numbers);
        steps_add(&all, status, numbers.iterations, now() - began);
        if (status > CART_POLE_ACCEPTABLE) {
            fprintf(stderr, "step %ld at p = %.3f m, phi = %.3f rad: %s\n", k, s[0], s[2], cart_pole_message(solver));
        }
    }
    printf("the pole stood within %.1f deg, at the end within %.2f deg and %.3f m\n", tilt * 180.0 / PI,
           fabs(s[2]) * 180.0 / PI, fabs(s[0] - parameters.goal));
    printf("memory reserved by create: %.1f MB, of it used %.1f MB; blocks allocated after it: %.0f\n",
           1e-6 * numbers.reserved, 1e-6 * numbers.used, numbers.helped_out);
    failed = steps_say(&all, cart_pole_text);
    cart_pole_destroy(solver);
    return failed > 0;
}
