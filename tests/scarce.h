/* scarce.h - an allocator for tests. Its memory runs out at a given call, and it checks what is given back: each block
   once, with the size that was asked for, nothing written behind it. What is read before it is written shows, and so do
   pointers to blocks that were given back. Include after a header of the library. */
#ifndef GXFEM_TESTS_SCARCE_H
#define GXFEM_TESTS_SCARCE_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { SCARCE_TAIL = 64 }; /* bytes behind each block, which must not change */
static const unsigned char scarce_behind = 0xc3;

typedef struct scarce_block { /* before each block */
    struct scarce_block *next, **last;
    size_t size;
    void *unused; /* keeps the alignment */
} scarce_block;

typedef struct memory {
    scarce_block *blocks; /* alive */
    size_t calls;         /* since fail_from */
    size_t fail_at;       /* this call fails, SIZE_MAX: none does */
    int from_then_on;     /* 1: and all after it */
    int grows;            /* 1: it makes blocks larger by itself */
    int refuses;          /* the next call fails, see runs_out */
    /* did one fail? was a block released with another size? was something written behind one? */
    int failed, wrong, overrun;
} memory;

/* test_tight.c: an array that has room asks too, which counts as a call. If that fails, the array asks for memory. */
#ifdef TIGHT
static memory *watched;

static int runs_out(const gx_allocator *a) {
    memory *m = watched;
    size_t call;
    if (m == NULL || a->user != m || m->refuses) return m != NULL && a->user == m;
    call = m->calls++;
    m->refuses = call == m->fail_at || (m->from_then_on && call > m->fail_at);
    return m->refuses;
}
#endif

static inline void fail_from(memory *m, size_t n, int from_then_on) {
#ifdef TIGHT
    watched = n == SIZE_MAX ? NULL : m;
#endif
    m->calls = 0;
    m->fail_at = n;
    m->from_then_on = from_then_on;
    m->failed = 0;
}

static inline void never_fail(memory *m) { fail_from(m, SIZE_MAX, 0); }

static inline memory plenty(void) {
    memory m;
    memset(&m, 0, sizeof m);
    m.fail_at = SIZE_MAX;
    return m;
}

static inline void *scarce_take(void *user, size_t size) {
    memory *m = (memory *)user;
    const size_t call = m->calls++;
    scarce_block *b;
    if (size == 0) m->wrong = 1;
    if (m->refuses || call == m->fail_at || (m->from_then_on && call > m->fail_at)) {
        m->refuses = 0;
        m->failed = 1;
        return NULL;
    }
    b = (scarce_block *)malloc(sizeof *b + size + SCARCE_TAIL);
    if (b == NULL) abort();
    memset(b + 1, 0xa5, size);
    memset((unsigned char *)(b + 1) + size, scarce_behind, SCARCE_TAIL);
    b->size = size;
    b->next = m->blocks;
    b->last = &m->blocks;
    if (b->next) b->next->last = &b->next;
    m->blocks = b;
    return b + 1;
}

static inline void scarce_give(void *user, void *memory_, size_t size) {
    memory *m = (memory *)user;
    scarce_block *b;
    size_t i;
    if (memory_ == NULL) {
        m->wrong = 1;
        return;
    }
    b = (scarce_block *)memory_ - 1;
    if (b->size != size) m->wrong = 1;
    for (i = 0; i < SCARCE_TAIL; i++)
        if (((unsigned char *)memory_)[b->size + i] != scarce_behind) m->overrun = 1;
    *b->last = b->next;
    if (b->next) b->next->last = b->last;
    memset(b, 0x5a, sizeof *b + b->size);
    free(b);
}

/* Always moves the block. */
static inline void *scarce_grow(void *user, void *memory_, size_t size, size_t larger) {
    memory *m = (memory *)user;
    void *moved = scarce_take(m, larger);
    if (memory_ == NULL || (larger <= size && moved != NULL)) m->wrong = 1;
    if (memory_ == NULL || moved == NULL) return moved;
    memcpy(moved, memory_, size);
    scarce_give(m, memory_, size);
    return moved;
}

static inline gx_allocator allocator_of(memory *m) {
    gx_allocator a;
    memset(&a, 0, sizeof a);
    a.allocate = scarce_take;
    a.release = scarce_give;
    a.reallocate = m->grows ? scarce_grow : NULL;
    a.user = m;
    return a;
}

static inline size_t bytes_alive(const memory *m) {
    const scarce_block *b;
    size_t bytes = 0;
    for (b = m->blocks; b != NULL; b = b->next) bytes += b->size;
    return bytes;
}

/* Has everything been given back, as it was taken? */
static inline int is_whole(const memory *m) { return m->blocks == NULL && !m->wrong && !m->overrun; }

/* Frees what a failed test has left. */
static inline void release_all(memory *m) {
    while (m->blocks) {
        scarce_block *b = m->blocks;
        m->blocks = b->next;
        free(b);
    }
}

#endif
