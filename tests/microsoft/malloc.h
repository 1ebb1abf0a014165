/* What of Microsoft's malloc.h clang's headers of intrinsics use, for platforms.sh */
#ifndef MICROSOFT_MALLOC_H
#define MICROSOFT_MALLOC_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif
void *_aligned_malloc(size_t size, size_t alignment);
void _aligned_free(void *memory);
#ifdef __cplusplus
}
#endif

#endif
