/* helper.h - a host with two threads, for benches. */
#ifndef GXFEM_BENCH_HELPER_H
#define GXFEM_BENCH_HELPER_H

#include <pthread.h>
#include <sched.h>
#include <string.h>

/* One thread that helps the calling one: both take the next index until there is none. Between passes it yields
   instead of sleeping, as job systems do: a pass takes some 20 microseconds, and waking a thread takes no less.
   Everything that both write is atomic. */
typedef struct helper {
    pthread_t thread;
    void (*task)(void *, size_t);
    void *context;
    size_t count, next;
    unsigned round, done; /* rounds of work: begun, and finished by the helper */
    int quit;
} helper;

static inline void helper_work(helper *h) {
    size_t i;
    while ((i = __atomic_fetch_add(&h->next, 1, __ATOMIC_RELAXED)) < h->count) h->task(h->context, i);
}

static inline void *helper_main(void *user) {
    helper *h = (helper *)user;
    unsigned seen = 0;
    while (!__atomic_load_n(&h->quit, __ATOMIC_ACQUIRE)) {
        if (__atomic_load_n(&h->round, __ATOMIC_ACQUIRE) == seen) {
            sched_yield();
            continue;
        }
        helper_work(h);
        __atomic_store_n(&h->done, ++seen, __ATOMIC_RELEASE);
    }
    return NULL;
}

static inline void helper_parallel_for(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    helper *h = (helper *)user;
    h->task = task;
    h->context = context;
    h->count = count;
    h->next = 0;
    __atomic_store_n(&h->round, h->round + 1, __ATOMIC_RELEASE);
    helper_work(h);
    while (__atomic_load_n(&h->done, __ATOMIC_ACQUIRE) != h->round) sched_yield();
}

static inline int helper_start(helper *h) {
    memset(h, 0, sizeof *h);
    return pthread_create(&h->thread, NULL, helper_main, h) == 0;
}

static inline void helper_stop(helper *h) {
    __atomic_store_n(&h->quit, 1, __ATOMIC_RELEASE);
    pthread_join(h->thread, NULL);
}

#endif /* GXFEM_BENCH_HELPER_H */
