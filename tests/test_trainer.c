/* test_trainer.c - the exercise of the scene trainer is the same, bit by bit, for any number of workers. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../examples/trainer.h"
#include "runner.h"

#include "pool.h"

enum { FRAMES = 90 /* of 20 a second: strokes, a twin that is loaded, one whose memory runs out */ };

/* The state's hash at the end. 0 workers: no threads, and tasks in a random order */
static uint64_t exercise_by(size_t workers) {
    char name[] = "trainer", small[] = "--small", quiet[] = "--quiet";
    char *arguments[] = {name, small, quiet};
    uint64_t order = 1, hash;
    trainer on;
    scene s;
    pool p;
    int i;
    pool_open(&p, workers > 0 ? workers : 1);
    scene_open(&s, &trainer_scene, 3, arguments);
    s.body_desc.jobs.parallel_for = workers > 0 ? pool_for : shuffled_for;
    s.body_desc.jobs.user = workers > 0 ? (void *)&p : (void *)&order;
    trainer_begin(&s, &on);
    for (i = 0; i < FRAMES; i++) {
        trainer_frame(&s, &on);
        trainer_watch(&s, &on);
    }
    hash = gx_body_state_hash(s.body);
    trainer_report(&s, &on);
    ck_assert_uint_eq(s.wrong, 0);
    ck_assert_uint_eq(on.twins, 2);
    ck_assert_uint_gt(on.ran_out, 0);
    ck_assert_uint_eq(on.refused, 12);
    ck_assert_uint_gt(on.judged, 100);
    trainer_end(&on);
    scene_close(&s);
    pool_close(&p);
    return hash;
}

START_TEST(workers_change_nothing) {
    const uint64_t one = exercise_by(1);
    ck_assert(exercise_by(2) == one);
    ck_assert(exercise_by(3) == one);
    ck_assert(exercise_by(0) == one);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("trainer");
    TCase *tcase = tcase_create("workers");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, workers_change_nothing);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
