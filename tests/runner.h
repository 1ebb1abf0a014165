/* Runs a suite of Check, some of it under a sanitizer, and returns what main returns. */
#ifndef GXFEM_TESTS_RUNNER_H
#define GXFEM_TESTS_RUNNER_H

#include <check.h>
#include <stdlib.h>

/* Random tests run on fewer seeds under a sanitizer, where they take ten times as long, and by a second compiler
   (-DFEWER=4). */
#if defined(FEWER)
#elif defined(__SANITIZE_ADDRESS__)
#define FEWER 6
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || __has_feature(undefined_behavior_sanitizer)
#define FEWER 6
#endif
#endif
#ifndef FEWER
#define FEWER 1
#endif

/* Adds a test for each of 0 ... count - 1, or for every seventh: coprime to what cases are combined of */
#define ADD_SOME(tcase, test, count)                                                                                   \
    do {                                                                                                               \
        int some_;                                                                                                     \
        for (some_ = 0; some_<(count); some_ += FEWER> 1 ? FEWER + 1 : 1)                                              \
            tcase_add_loop_test(tcase, test, some_, some_ + 1);                                                        \
    } while (0)

static inline int run_suite(Suite *suite) {
    SRunner *runner = srunner_create(suite);
    int failed;
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

#endif /* GXFEM_TESTS_RUNNER_H */
