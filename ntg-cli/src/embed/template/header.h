/*
 * @NAME@.h: plans of the problem `@PROBLEM@`. Written by `ntg embed` @VERSION@ from @SOURCE@.
 *
@DOC@ *
 * Numbers are in the units that stand beside them, times in seconds. A plan begins at its start (see @NAME@_info).
 *
 *   create    makes the first plan, from the guess of the spec; it takes as long as `ntg solve` does
 *   set       other parameters, such as a state that was measured
 *   solve     the next plan from the present one, within limits
 *   read      outputs and named expressions of the present plan, at times
 *   destroy
 *
 * Failures. Every function that returns an int returns one of the statuses below. After a failure, parameters and plan are
 * what they were, and @NAME@_message says what is wrong. Nothing ends the program.
 *
 * Memory. create reserves all that a solver needs. The other functions allocate nothing from the system; should the reserve
 * not suffice after all, they still work, and `helped_out` in @NAME@_info counts the blocks.
 *
 * Threads. No function starts one. Solvers are independent: each may be used by a thread of its own. A solver may go from
 * thread to thread; a call while another thread is in one returns @UPPER@_BUSY and does nothing.
 *
 * No function opens a file, prints, or reads anything but the clock.
 */
#ifndef @UPPER@_H
#define @UPPER@_H

#ifdef __cplusplus
extern "C" {
#endif

/** What a function returns. There is a new plan where a solve returns at most @UPPER@_ACCEPTABLE. */
typedef enum @NAME@_status {
@STATUSES@
} @NAME@_status;

/** All parameters. `@NAME@_parameters p = @UPPER@_DEFAULTS;` are those of the spec. */
typedef struct @NAME@_parameters {
@MEMBERS@
} @NAME@_parameters;

/** The parameters of the spec, to initialise an @NAME@_parameters. */
#define @UPPER@_DEFAULTS { \
    @DEFAULTS@ \
}

/** What can be read from a plan. */
typedef enum @NAME@_reading {
@READINGS@
} @NAME@_reading;

/** How many readings there are. */
#define @UPPER@_READINGS @COUNT@

/** The last solve, the present plan, and the memory. */
typedef struct @NAME@_numbers {
    /** The objective of the last solve, @OBJECTIVE@. */
    double objective;
    /** Wall-clock time of the last solve in seconds. */
    double seconds;
    /** Start of the present plan in seconds. */
    double start;
    /** End of the present plan in seconds. */
    double end;
    /** Bytes that create has reserved. */
    double reserved;
    /** Bytes of them that were in use at some time. */
    double used;
    /** Blocks of memory that were allocated after create: 0, or the reserve did not suffice. */
    double helped_out;
    /** Iterations of the last solve. */
    int iterations;
    /** How the last solve ended, as one of the statuses. */
    int status;
} @NAME@_numbers;

/** A problem with its parameters, its plan and its memory. */
typedef struct @NAME@_solver @NAME@_solver;

/**
 * Makes a solver and its first plan.
 *
 * `parameters` may be null: then they are those of the spec. On success `*out` is the solver, else null, and
 * @NAME@_message(NULL) says on this thread what is wrong: a parameter (@UPPER@_BAD_PARAMETER), or no plan was found.
 */
int @NAME@_create(const @NAME@_parameters *parameters, @NAME@_solver **out);

/** Sets all parameters for the solves to come. One that is not finite: @UPPER@_BAD_PARAMETER, and none is set. */
int @NAME@_set(@NAME@_solver *solver, const @NAME@_parameters *parameters);

/**
 * Makes the next plan, starting from the present one.
 *
 * The solve ends after `max_iterations` iterations and after the first iteration that ends later than `max_seconds` seconds;
 * 0 stands for no limit of yours. On a failure the present plan stays, and the next solve starts from it again.
 */
int @NAME@_solve(@NAME@_solver *solver, int max_iterations, double max_seconds);

/** Returns to the plan of create, as a start after many failures or for a new task. Parameters stay. */
int @NAME@_reset(@NAME@_solver *solver);

/**
 * Reads the present plan: `reading` is one of @NAME@_reading, `derivative` 0 or the order of a derivative by time (of
 * outputs only, in their unit per second to that power), `time` in seconds. Before its start and after its end a plan is
 * what it is there. On a failure `*value` is not written.
 */
int @NAME@_read(@NAME@_solver *solver, int reading, int derivative, double time, double *value);

/** Numbers about the last solve, the present plan and the memory. */
int @NAME@_info(@NAME@_solver *solver, @NAME@_numbers *out);

/**
 * Why the last call with this solver that failed did so, in words (UTF-8); with null, why the last create of this thread
 * failed. The text stays until the next call that fails.
 */
const char *@NAME@_message(@NAME@_solver *solver);

/** What a status means, in words. */
const char *@NAME@_text(int status);

/** Ends a solver and gives its memory back; null is nothing. */
void @NAME@_destroy(@NAME@_solver *solver);

#ifdef __cplusplus
}
#endif

#endif
