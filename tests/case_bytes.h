/* case_bytes.h - bytes of which random cases are made: read from the front, 0 after the last. */
#ifndef GXFEM_TESTS_CASE_BYTES_H
#define GXFEM_TESTS_CASE_BYTES_H

#include "../bench/splitmix.h"
#include <stddef.h>
#include <stdint.h>

typedef struct case_bytes {
    const uint8_t *data;
    size_t size, at;
} case_bytes;

static inline uint32_t case_take(case_bytes *b) { return b->at < b->size ? b->data[b->at++] : 0; }
static inline uint32_t case_below(case_bytes *b, uint32_t n) { return case_take(b) % n; }

/* The bytes of a random case: splitmix64. size: a multiple of 8 */
static inline void case_fill(uint64_t seed, uint8_t *bytes, int size) {
    uint64_t state = seed * UINT64_C(0xda942042e4dd58b5);
    int i, k;
    for (i = 0; i < size; i += 8) {
        const uint64_t z = splitmix64(&state);
        for (k = 0; k < 8; k++) bytes[i + k] = (uint8_t)(z >> 8 * k);
    }
}

#endif
