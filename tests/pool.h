/* pool.h - a host's threads for tests: a pool of POSIX threads, and a hook that runs tasks one by one in random order.
   Include after a header of the library and runner.h. Link with -pthread. */
#ifndef GXFEM_TESTS_POOL_H
#define GXFEM_TESTS_POOL_H

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { POOL_THREADS = 8 };

typedef struct pool {
    pthread_t thread[POOL_THREADS];
    size_t workers; /* with the thread that calls */
    pthread_mutex_t lock;
    pthread_cond_t begun, ended;
    void (*task)(void *, size_t);
    void *context;
    size_t count, next, running, calls; /* running: threads at work on this call */
    int quit;
} pool;

/* Takes tasks until there are no more. The lock is held before and after. */
static void pool_work(pool *p) {
    while (p->next < p->count) {
        const size_t i = p->next++;
        void (*task)(void *, size_t) = p->task;
        void *context = p->context;
        pthread_mutex_unlock(&p->lock);
        task(context, i);
        pthread_mutex_lock(&p->lock);
    }
}

static void *pool_thread(void *argument) {
    pool *p = (pool *)argument;
    size_t seen = 0;
    pthread_mutex_lock(&p->lock);
    while (!p->quit) {
        if (p->calls == seen) {
            pthread_cond_wait(&p->begun, &p->lock);
            continue;
        }
        seen = p->calls;
        p->running++;
        pool_work(p);
        if (--p->running == 0) pthread_cond_signal(&p->ended);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

static void pool_for(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    pool *p = (pool *)user;
    pthread_mutex_lock(&p->lock);
    p->task = task;
    p->context = context;
    p->count = count;
    p->next = 0;
    p->calls++;
    pthread_cond_broadcast(&p->begun);
    pool_work(p);
    while (p->running > 0) pthread_cond_wait(&p->ended, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

static void pool_open(pool *p, size_t workers) {
    size_t i;
    memset(p, 0, sizeof *p);
    p->workers = workers;
    ck_assert_int_eq(pthread_mutex_init(&p->lock, NULL), 0);
    ck_assert_int_eq(pthread_cond_init(&p->begun, NULL), 0);
    ck_assert_int_eq(pthread_cond_init(&p->ended, NULL), 0);
    for (i = 1; i < workers; i++) ck_assert_int_eq(pthread_create(&p->thread[i], NULL, pool_thread, p), 0);
}

static void pool_close(pool *p) {
    size_t i;
    pthread_mutex_lock(&p->lock);
    p->quit = 1;
    pthread_cond_broadcast(&p->begun);
    pthread_mutex_unlock(&p->lock);
    for (i = 1; i < p->workers; i++) ck_assert_int_eq(pthread_join(p->thread[i], NULL), 0);
    pthread_cond_destroy(&p->ended);
    pthread_cond_destroy(&p->begun);
    pthread_mutex_destroy(&p->lock);
}

/* Each task once, one after the other, in a random order; *user: the state of the generator. Of tasks that write what
   another one reads, some order shows it. */
static void shuffled_for(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    uint64_t *state = (uint64_t *)user;
    size_t *order = (size_t *)malloc((count + 1) * sizeof *order), i;
    ck_assert(order != NULL);
    for (i = 0; i < count; i++) {
        size_t j;
        *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        j = (size_t)(*state >> 33) % (i + 1);
        order[i] = order[j];
        order[j] = i;
    }
    for (i = 0; i < count; i++) task(context, order[i]);
    free(order);
}

#endif /* GXFEM_TESTS_POOL_H */
