/* test_soak.c - lives of bodies that are cut, kicked and dropped (bench/soak.h): nothing runs away, no energy is
   gained, no call fails. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../bench/soak.h"
#include "body.h"

/* A copy that runs away is beyond 1e10 times the rest. For speeds, one step of a light copy in contact is tolerated
   (make bench-soak prints them). */
START_TEST(nothing_runs_away) {
    row r;
    memset(&r, 0, sizeof r);
    run_life(_i, 0, 0, &r);
    ck_assert_uint_eq(r.errors, 0);
    ck_assert_uint_gt(r.cuts, 20);
    ck_assert_msg(r.reach < 10 && r.speed < 100, "a copy is %g times as far as the rest, %g times as fast", r.reach,
                  r.speed);
    ck_assert_msg(r.gain < (_i == GXS_MIDPOINT ? 0.0101 : 1e-7), "gains %g", r.gain);
}
END_TEST

static Suite *soak_suite(void) {
    Suite *suite = suite_create("soak");
    TCase *tests = tcase_create("lives");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, nothing_runs_away, 0, FEWER > 1 ? 1 : INTEGRATORS);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void) { return run_suite(soak_suite()); }
