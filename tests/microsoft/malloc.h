/* malloc.h of Microsoft's library, as far as clang's headers of intrinsics use it */
#ifndef TEST_MALLOC_H
#define TEST_MALLOC_H
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
