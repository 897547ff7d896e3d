/* Reads an .nl file with the AMPL Solver Library, whose .nl reader is the reference, and
 *
 *     asl_ipopt eval  stub.nl < points     evaluates at points (as many numbers as variables, any number of points):
 *                                          one line each: f, gradient, rows, Jacobian as "row column value" after "J"
 *     asl_ipopt solve stub.nl [tol] [s]    solves with IPOPT from the file's start and writes stub.sol
 *
 * Nothing of ntg is in here: it is an outside reader of what `ntg export` writes.
 * Build: gcc -O2 asl_ipopt.c -I/usr/include/ampl-netlib-solvers -I$COIN_INCLUDE -lamplsolver $LIBIPOPT -lm (bench/nl/run does).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "asl_pfgh.h"
#undef filename
#undef Char
#include "IpStdCInterface.h"

#define asl cur_ASL

static double value(double *x, int *bad) {
  fint error = 0;
  double f = n_obj > 0 ? objval(0, x, &error) : 0;
  *bad = error != 0;
  return f;
}

static bool eval_f(ipindex n, ipnumber *x, bool new_x, ipnumber *f, UserDataPtr user) {
  int bad;
  *f = value(x, &bad);
  if (objtype[0]) *f = -*f;
  return !bad;
}

static bool eval_grad_f(ipindex n, ipnumber *x, bool new_x, ipnumber *g, UserDataPtr user) {
  fint error = 0;
  objgrd(0, x, g, &error);
  if (objtype[0]) for (int i = 0; i < n; i++) g[i] = -g[i];
  return !error;
}

static bool eval_g(ipindex n, ipnumber *x, bool new_x, ipindex m, ipnumber *g, UserDataPtr user) {
  fint error = 0;
  conval(x, g, &error);
  return !error;
}

static void jacobian_pattern(ipindex *rows, ipindex *columns) {
  for (int i = 0; i < n_con; i++)
    for (cgrad *c = Cgrad[i]; c; c = c->next) rows[c->goff] = i, columns[c->goff] = c->varno;
}

static bool eval_jac_g(ipindex n, ipnumber *x, bool new_x, ipindex m, ipindex k, ipindex *rows, ipindex *columns,
                       ipnumber *values, UserDataPtr user) {
  if (!values) return jacobian_pattern(rows, columns), true;
  fint error = 0;
  jacval(x, values, &error);
  return !error;
}

static bool eval_h(ipindex n, ipnumber *x, bool new_x, ipnumber factor, ipindex m, ipnumber *y, bool new_y, ipindex k,
                   ipindex *rows, ipindex *columns, ipnumber *values, UserDataPtr user) {
  if (!values) {
    int at = 0;
    for (int j = 0; j < n; j++)
      for (int i = sputinfo->hcolstarts[j]; i < sputinfo->hcolstarts[j + 1]; i++, at++)
        rows[at] = sputinfo->hrownos[i], columns[at] = j;
    return true;
  }
  double weight = objtype[0] ? -factor : factor;
  /* The Hessian is that of the last point at which values were asked for. */
  fint error = 0;
  int bad;
  value(x, &bad);
  double *at = malloc((m + 1) * sizeof(double));
  conval(x, at, &error);
  free(at);
  sphes(values, -1, &weight, y);
  return !error && !bad;
}

static int iterations;
static bool each(ipindex mode, ipindex count, ipnumber f, ipnumber pr, ipnumber du, ipnumber mu, ipnumber d, ipnumber reg,
                 ipnumber ad, ipnumber ap, ipindex trials, UserDataPtr user) {
  iterations = count;
  return true;
}

static int evaluate(void) {
  double *x = malloc(n_var * sizeof(double)), *g = malloc((n_con + 1) * sizeof(double));
  double *grad = malloc(n_var * sizeof(double)), *jac = malloc((nzc + 1) * sizeof(double));
  ipindex *rows = malloc((nzc + 1) * sizeof(ipindex)), *columns = malloc((nzc + 1) * sizeof(ipindex));
  jacobian_pattern(rows, columns);
  for (;;) {
    for (int i = 0; i < n_var; i++)
      if (scanf("%lf", x + i) != 1) return 0;
    int bad;
    fint error = 0;
    printf("%.17g", value(x, &bad));
    objgrd(0, x, grad, &error);
    conval(x, g, &error);
    jacval(x, jac, &error);
    for (int i = 0; i < n_var; i++) printf(" %.17g", grad[i]);
    for (int i = 0; i < n_con; i++) printf(" %.17g", g[i]);
    printf(" J");
    for (int i = 0; i < nzc; i++) printf(" %d %d %.17g", rows[i], columns[i], jac[i]);
    printf("\n");
  }
}

static int solve(double tol, double seconds) {
  int nh = sphsetup(-1, 1, n_con > 0, 1);
  IpoptProblem p = CreateIpoptProblem(n_var, LUv, Uvx, n_con, LUrhs, Urhsx, nzc, nh, 0, eval_f, eval_g, eval_grad_f,
                                      eval_jac_g, eval_h);
  AddIpoptNumOption(p, "tol", tol);
  AddIpoptNumOption(p, "max_wall_time", seconds);
  AddIpoptIntOption(p, "print_level", 0);
  AddIpoptStrOption(p, "sb", "yes");
  SetIntermediateCallback(p, each);
  double *x = malloc(n_var * sizeof(double)), *y = calloc(n_con + 1, sizeof(double)), f = 0;
  memcpy(x, X0, n_var * sizeof(double));
  int status = IpoptSolve(p, x, NULL, &f, y, NULL, NULL, NULL);
  /* AMPL's multipliers are d(objective) / d(bound). */
  for (int i = 0; i < n_con; i++) y[i] = objtype[0] ? y[i] : -y[i];
  char words[100];
  snprintf(words, sizeof words, "IPOPT %d, %d iterations", status, iterations);
  solve_result_num = status == 0 ? 0 : 500;
  write_sol(words, x, y, NULL);
  printf("{\"status\": %d, \"iterations\": %d, \"objective\": %.17g}\n", status, iterations, objtype[0] ? -f : f);
  return 0;
}

int main(int argc, char **argv) {
  if (argc < 3) return fprintf(stderr, "usage: asl_ipopt eval|solve FILE.nl [TOL] [SECONDS]\n"), 2;
  ASL_alloc(ASL_read_pfgh);
  FILE *nl = jac0dim(argv[2], (fint)strlen(argv[2]));
  want_xpi0 = 1;
  X0 = calloc(n_var, sizeof(double));
  LUv = malloc(n_var * sizeof(double)), Uvx = malloc(n_var * sizeof(double));
  LUrhs = malloc((n_con + 1) * sizeof(double)), Urhsx = malloc((n_con + 1) * sizeof(double));
  pfgh_read(nl, ASL_findgroups);
  if (strcmp(argv[1], "eval") == 0) return evaluate();
  return solve(argc > 3 ? atof(argv[3]) : 1e-8, argc > 4 ? atof(argv[4]) : 60);
}
