/* What of C's stdlib.h the headers use, for platforms.sh */
#ifndef MICROSOFT_STDLIB_H
#define MICROSOFT_STDLIB_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif
void *malloc(size_t size);
void *realloc(void *memory, size_t size);
void *bsearch(const void *key, const void *items, size_t count, size_t size,
              int (*compare)(const void *, const void *));
void free(void *memory);
void qsort(void *items, size_t count, size_t size, int (*compare)(const void *, const void *));
#ifdef __cplusplus
}
#endif

#endif
