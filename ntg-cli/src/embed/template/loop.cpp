// A closed loop in C++: the solver ends by itself, and failures are exceptions. What it does is said in loop.c.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "@NAME@.h"

namespace {

struct Destroy {
    void operator()(@NAME@_solver *solver) const noexcept { @NAME@_destroy(solver); }
};
using Solver = std::unique_ptr<@NAME@_solver, Destroy>;

void check(@NAME@_solver *solver, int status) {
    if (status > @UPPER@_ACCEPTABLE) {
        throw std::runtime_error(std::string(@NAME@_text(status)) + ": " + @NAME@_message(solver));
    }
}

Solver create(const @NAME@_parameters &parameters) {
    @NAME@_solver *solver = nullptr;
    check(nullptr, @NAME@_create(&parameters, &solver));
    return Solver(solver);
}

void run(long steps) {
    @NAME@_parameters parameters = @UPPER@_DEFAULTS;
    const Solver owner = create(parameters);
    @NAME@_solver *const solver = owner.get();
    @NAME@_numbers numbers{};
    check(solver, @NAME@_info(solver, &numbers));
    const double step = 0.01 * (numbers.end - numbers.start);
    for (long k = 0;; ++k) {
        std::printf("%ld %d %d", k, numbers.status, numbers.iterations);
        for (const int reading : {@SHOWN@}) {
            double value = 0.0;
            check(solver, @NAME@_read(solver, reading, 0, numbers.start, &value));
            std::printf(" %a", value);
        }
        std::printf("\n");
        if (k == steps) return;

        // What is measured a step later.
@MEASURE_CPP@
        check(solver, @NAME@_set(solver, &parameters));
        check(solver, @NAME@_solve(solver, 100, 1.0));
        check(solver, @NAME@_info(solver, &numbers));
    }
}

}  // namespace

int main(int words, char **word) {
    try {
        run(words > 1 ? std::strtol(word[1], nullptr, 10) : 10);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
