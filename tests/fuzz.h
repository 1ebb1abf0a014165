/* fuzz.h - the frame of a program that tests cases made from bytes. A case that fails is written as a file, which
   replays by itself.

       FUZZ FILE...                            replays cases
       FUZZ --seed=S --cases=N --seconds=T     random cases from seed S on, until N are done or T seconds have
                                               passed (0: no such limit)
            --out=FOLDER                       where a failing case is written (FUZZ_FOLDER)

   With -DFUZZ_LIBFUZZER it has no main: libFuzzer calls LLVMFuzzerTestOneInput. Bytes are read from the front, 0 after
   the last. Before it includes this, the program defines _XOPEN_SOURCE 700, FUZZ_FOLDER, FUZZ_BYTES (of a random case)
   and FUZZ_SECONDS (of the processor, within which a case must end); after it, the functions below. */
#ifndef GXFEM_TESTS_FUZZ_H
#define GXFEM_TESTS_FUZZ_H

#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef _WIN32
#include <io.h>
#include <sys/stat.h>
#else
#include <unistd.h>
#endif
#if defined(__wasi__) /* no signals, and no jump back: the first failure ends the program */
typedef int jmp_buf[1];
#define setjmp(buffer)         ((void)(buffer), 0)
#define longjmp(buffer, value) exit(value)
#else
#include <setjmp.h>
#include <signal.h>
#ifndef _WIN32
#include <sys/time.h>
#endif
#endif

#include "case_bytes.h"

static void test_bytes(const uint8_t *bytes, size_t size); /* runs a case; what is wrong calls fail */
static void begin_fuzz(void);                              /* before the first case, and before each that is replayed */
static void drop_case(void);                               /* after a case that failed */
static void end_fuzz(void);                                /* after the last case */
static void print_counts(void);                            /* what was tested, between "; " and ", " */
static int take_option(const char *argument);              /* is it one of the program's own? */

/* ---- failures ---- */

static struct {
    const uint8_t *bytes;
    size_t size;
    uint64_t seed; /* of a random case */
    int random;
    uint64_t cases;
    const char *folder;
    jmp_buf back;
} at;

/* Calls only functions that a signal handler may call. */
static void write_case(void) {
    static const char digits[] = "0123456789abcdef";
    char path[512];
    size_t length = strlen(at.folder);
    int i, file;
    if (length > sizeof path - 32) return;
    memcpy(path, at.folder, length);
    memcpy(path + length, "/case-", 6);
    for (i = 0; i < 16; i++) path[length + 6 + (size_t)i] = digits[at.seed >> (60 - 4 * i) & 15];
    path[length + 22] = '\0';
#ifdef _WIN32
    file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_BINARY, S_IREAD | S_IWRITE);
#else
    file = creat(path, 0644);
#endif
    if (file < 0 || write(file, at.bytes, (unsigned)at.size) != (int)at.size) return;
    close(file);
    if (write(2, path, length + 22) < 0 || write(2, "\n", 1) < 0) return;
}

static void fail(const char *format, ...) {
    va_list list;
    va_start(list, format);
    if (at.random)
        fprintf(stderr, "fuzz: seed %llu: ", (unsigned long long)at.seed);
    else
        fprintf(stderr, "fuzz: ");
    vfprintf(stderr, format, list);
    fprintf(stderr, "\n");
    va_end(list);
    if (at.random) write_case();
#ifdef FUZZ_LIBFUZZER
    abort();
#else
    longjmp(at.back, 1);
#endif
}

#define REQUIRE(condition, ...)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) fail(__VA_ARGS__);                                                                           \
    } while (0)

/* ---- cases ---- */

static void run_case(const uint8_t *bytes, size_t size) {
    at.bytes = bytes;
    at.size = size;
    at.cases++;
    test_bytes(bytes, size);
}

#ifdef FUZZ_LIBFUZZER

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (at.cases == 0) begin_fuzz();
    run_case(data, size);
    return 0;
}

#else

#if defined(__wasi__)
static void catch_signals(void) {}
static void allow_a_case(void) {}
#else
static void say_and_end(const char *what) {
    if (write(2, what, (unsigned)strlen(what)) >= 0 && at.random) write_case();
    _exit(2);
}

static void on_signal(int number) {
    (void)number;
    say_and_end("fuzz: a crash\n");
}

#ifdef _WIN32 /* no timer of the processor's time: a case without end runs on */
static void allow_a_case(void) {}
static void catch_slow_cases(void) {}
#else
static void on_timer(int number) {
    (void)number;
    say_and_end("fuzz: a case without end\n");
}

/* Processor time, since other programs may take their share */
static void allow_a_case(void) {
    const struct itimerval limit = {{0, 0}, {FUZZ_SECONDS, 0}};
    setitimer(ITIMER_VIRTUAL, &limit, NULL);
}

static void catch_slow_cases(void) { signal(SIGVTALRM, on_timer); }
#endif

static void catch_signals(void) {
    signal(SIGSEGV, on_signal);
    signal(SIGABRT, on_signal);
    signal(SIGFPE, on_signal);
    catch_slow_cases();
}
#endif

static int run_seeds(uint64_t seed, uint64_t cases, long seconds) {
    static uint8_t bytes[FUZZ_BYTES];
    const time_t start = time(NULL);
    volatile int failed = 0;
    volatile uint64_t i;
    at.random = 1;
    begin_fuzz();
    for (i = 0; (cases == 0 || i < cases) && failed < 20; i++) {
        allow_a_case();
        if (i % 16 == 0 && seconds > 0 && time(NULL) - start >= seconds) break;
        at.seed = seed + i;
        case_fill(at.seed, bytes, FUZZ_BYTES);
        if (setjmp(at.back)) {
            failed++;
            drop_case();
        } else
            run_case(bytes, FUZZ_BYTES);
    }
    printf("%llu cases from seed %llu, %d failed; ", (unsigned long long)at.cases, (unsigned long long)seed, failed);
    print_counts();
    printf(", %ld s\n", (long)(time(NULL) - start));
    return failed != 0;
}

static int run_file(const char *path) {
    static uint8_t bytes[1 << 16];
    FILE *file = fopen(path, "rb");
    size_t size;
    if (file == NULL) {
        fprintf(stderr, "fuzz: %s: cannot be read\n", path);
        return 1;
    }
    size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    at.random = 0;
    begin_fuzz();
    allow_a_case();
    if (setjmp(at.back)) {
        fprintf(stderr, "fuzz: %s failed\n", path);
        drop_case();
        return 1;
    }
    run_case(bytes, size);
    return 0;
}

int main(int argc, char **argv) {
    unsigned long long seed = 1, cases = 0, seconds = 0;
    int i, files = 0, failed = 0;
    at.folder = FUZZ_FOLDER;
    catch_signals();
    for (i = 1; i < argc; i++) {
        if (strncmp(argv[i], "--seed=", 7) == 0)
            seed = strtoull(argv[i] + 7, NULL, 10);
        else if (strncmp(argv[i], "--cases=", 8) == 0)
            cases = strtoull(argv[i] + 8, NULL, 10);
        else if (strncmp(argv[i], "--seconds=", 10) == 0)
            seconds = strtoull(argv[i] + 10, NULL, 10);
        else if (strncmp(argv[i], "--out=", 6) == 0)
            at.folder = argv[i] + 6;
        else if (!take_option(argv[i])) {
            failed += run_file(argv[i]);
            files++;
        }
    }
    if (files > 0)
        printf("%d files, %d failed\n", files, failed);
    else
        failed = run_seeds(seed, cases == 0 && seconds == 0 ? 10000 : cases, (long)seconds);
    end_fuzz();
    return failed != 0;
}

#endif

#endif /* GXFEM_TESTS_FUZZ_H */
