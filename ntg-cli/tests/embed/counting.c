/* Counts what a program allocates, by standing in for the C library's own functions. */
#include "counting.h"

#ifdef __GLIBC__

#include <errno.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);
extern void __libc_free(void *);

static long calls = 0;

long allocations(void) { return calls; }

void *malloc(size_t size) {
    ++calls;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    ++calls;
    return __libc_calloc(count, size);
}

void *realloc(void *place, size_t size) {
    ++calls;
    return __libc_realloc(place, size);
}

void *aligned_alloc(size_t align, size_t size) {
    ++calls;
    return __libc_memalign(align, size);
}

int posix_memalign(void **out, size_t align, size_t size) {
    ++calls;
    *out = __libc_memalign(align, size);
    return *out != NULL ? 0 : ENOMEM;
}

void free(void *place) {
    if (place != NULL) ++calls;
    __libc_free(place);
}

#else

long allocations(void) { return -1; }

#endif
