/* Runs a suite of Check and says how it went, as main returns it. */
#ifndef GXFEM_TESTS_RUNNER_H
#define GXFEM_TESTS_RUNNER_H

#include <check.h>
#include <stdlib.h>

static inline int run_suite(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    int failed;
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

#endif /* GXFEM_TESTS_RUNNER_H */
