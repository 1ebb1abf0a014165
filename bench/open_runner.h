/* open_runner.h - what runners of other kernels share: the command line of the Open Boolean Benchmark around an engine.
 */
#ifndef BENCH_OPEN_RUNNER_H
#define BENCH_OPEN_RUNNER_H

#include "../examples/gxio.h"

#include "../examples/gxrunner.h"

/* name --request FILE --result FILE; solids that a later operation takes are not written */
static inline int open_run(const char *name, const gxrunner_engine *engine, int argc, char **argv) {
    gxrunner_options options = {NULL, NULL, ".off", 1};
    gxio_error error;
    int code;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--request") == 0) options.request = argv[i + 1];
        if (strcmp(argv[i], "--result") == 0) options.result = argv[i + 1];
    }
    if (!options.request || !options.result) {
        fprintf(stderr, "usage: %s --request FILE --result FILE\n", name);
        return 2;
    }
    code = gxrunner_serve(&options, engine, &error);
    if (code == GXRUNNER_MISUSED) fprintf(stderr, "%s: %s\n", name, error.text);
    return code;
}

#endif
