/* How often memory was asked for or given back since the program began; -1 where it cannot be counted. */
#ifndef COUNTING_H
#define COUNTING_H

#include <stdlib.h>

long allocations(void);

#endif
