/* system.c - what examples ask of the system: a clock, and a file that takes another one's place. platforms.sh runs it.

       system FOLDER   prints what is wrong, then "N failed" */
#include "../examples/gxio.h"

static int failed;

static void check(int good, const char *what) {
    if (good) return;
    printf("FAILED %s\n", what);
    failed++;
}

/* The clock never goes back, tells less than a millisecond, and goes as fast as the system's own by seconds. */
static void check_clock(void) {
    const time_t first = time(NULL);
    double start, before, now, least = 1;
    time_t second;
    while ((second = time(NULL)) == first) {}
    start = before = gxio_seconds(NULL);
    while (time(NULL) < second + 2) {
        now = gxio_seconds(NULL);
        check(now >= before, "the clock goes back");
        if (now > before && now - before < least) least = now - before;
        before = now;
    }
    check(least < 1e-3, "the clock has steps of a millisecond or more");
    check(before - start > 1 && before - start < 4, "two seconds are not two by the clock");
}

static int write_number(const char *path, int number, int good) {
    gxio_writer writer;
    gxio_error error;
    if (!gxio_writer_open(&writer, path, &error)) return 0;
    fprintf(writer.stream, "%d\n", number);
    return gxio_writer_close(&writer, good, &error);
}

static int read_number(const char *path) {
    FILE *file = fopen(path, "rb");
    int number = -1;
    if (!file) return -1;
    if (fscanf(file, "%d", &number) != 1) number = -1;
    fclose(file);
    return number;
}

/* A file is replaced as a whole; one that fails leaves the old one, and none of its own. */
static void check_files(const char *folder) {
    char path[512], part[520];
    int i;
    gxio_error error;
    check(gxio_make_directory(folder, &error), "a folder cannot be made");
    check(gxio_make_directory(folder, &error), "a folder that is there is an error");
    snprintf(path, sizeof path, "%s/number", folder);
    snprintf(part, sizeof part, "%s.part", path);
    for (i = 0; i < 100; i++) {
        check(write_number(path, i, 1), "a file is not replaced");
        check(read_number(path) == i, "a file that was replaced is not the new one");
        check(!write_number(path, 1000, 0), "a file that failed is no failure");
        check(read_number(path) == i, "a file that failed has replaced another one");
        check(read_number(part) == -1, "a temporary file stays");
    }
    remove(path);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: system FOLDER\n");
        return 2;
    }
    check_clock();
    check_files(argv[1]);
    printf("%d failed\n", failed);
    return failed > 0;
}
