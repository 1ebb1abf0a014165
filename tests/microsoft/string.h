/* What of C's string.h the headers use, for platforms.sh */
#ifndef MICROSOFT_STRING_H
#define MICROSOFT_STRING_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif
int memcmp(const void *a, const void *b, size_t size);
void *memcpy(void *to, const void *from, size_t size);
void *memmove(void *to, const void *from, size_t size);
void *memset(void *to, int value, size_t size);
int strcmp(const char *a, const char *b);
size_t strlen(const char *text);
#ifdef __cplusplus
}
#endif

#endif
