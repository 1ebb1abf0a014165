/* gxio.h: what the examples read and write. Plain arrays in and out; knows nothing of gxfem.h.

   contents
     >>errors      one line of text: file, line, cause
     >>reader      a whole file in memory, read token by token
     >>arguments   numbers and lists of numbers out of a command line
     >>mesh        a tetrahedral mesh; Medit .mesh, TetGen .node/.ele
     >>gmsh        Gmsh .msh
     >>vtk         what legacy .vtk files of meshes and surfaces share; meshes
     >>generate    generated meshes: cube5, grid:..., tet, shapes of gxshape.h; any mesh by its name
     >>surface     triangle surfaces: .obj, .off, .stl, .vtk, generated plane:..., box:..., wave:...
     >>blade       the edge of a blade, frame by frame
     >>writer      files that are either complete or not there
     >>shells      a triangle surface as .off, .obj or .stl
     >>frames      triangles with fragment ids as .vtu or .obj, and the .pvd collection of a run
     >>page        frames as one .html file that a browser plays
     >>clock       seconds, directories

   Every function that can fail returns 1 on success and 0 on failure, with one line in error->text.
   What a failed function was filling is empty or released by the matching gxio_*_release. */
#ifndef GXIO_H
#define GXIO_H

#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L /* clock_gettime; include this file before the system's */
#endif

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef _WIN32
#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <direct.h>
#include <windows.h>
#undef near /* words of segmented memory */
#undef far
#else
#include <sys/stat.h>
#include <sys/types.h>
#endif
#include "gxshape.h"
#include "player.h"

enum { GXIO_PATH_ROOM = 1024 }; /* longest path, with its terminator, bytes */

/* ------------------------------------------------------------------------------------------------ >>errors */

typedef struct gxio_error {
    char text[2 * GXIO_PATH_ROOM];
} gxio_error;

/* Writes "PATH:LINE: cause" (line 0: "PATH: cause"). Returns 0, so that a caller can return it. */
static inline int gxio_fail(gxio_error *error, const char *path, size_t line, const char *format, ...) {
    const size_t room = sizeof error->text;
    va_list arguments;
    int used = line ? snprintf(error->text, room, "%s:%lu: ", path, (unsigned long)line)
                    : snprintf(error->text, room, "%s: ", path);
    if (used < 0 || (size_t)used >= room) return 0;
    va_start(arguments, format);
    vsnprintf(error->text + used, room - (size_t)used, format, arguments);
    va_end(arguments);
    return 0;
}

/* ------------------------------------------------------------------------------------------------ >>reader */

typedef struct gxio_reader {
    const char *path;
    char *text;           /* the whole file and a terminating 0; owned */
    const char *at, *end; /* next character; the terminating 0 */
    size_t line;          /* of `at`, from 1 */
    const char *token;    /* the last token read, not terminated */
    size_t token_length, token_line;
} gxio_reader;

enum { GXIO_SAME_LINE = 0, GXIO_ANY_LINE = 1 }; /* where the next token may stand */

static inline void gxio_reader_release(gxio_reader *reader) {
    free(reader->text);
    memset(reader, 0, sizeof *reader);
}

/* The bytes of a file and a terminating 0, to be freed by the caller. NULL on failure; errno says why. */
static inline char *gxio_slurp(const char *path, size_t *length) {
    size_t capacity = 1 << 16, used = 0;
    FILE *stream = fopen(path, "rb");
    char *text = stream ? (char *)malloc(capacity) : NULL;
    while (text) {
        char *grown;
        used += fread(text + used, 1, capacity - used - 1, stream);
        if (used < capacity - 1) break;
        grown = (char *)realloc(text, 2 * capacity);
        if (!grown) {
            free(text);
            text = NULL;
            break;
        }
        text = grown;
        capacity *= 2;
    }
    if (text && ferror(stream)) {
        free(text);
        text = NULL;
    }
    if (text) text[used] = 0;
    if (stream) fclose(stream);
    *length = used;
    return text;
}

/* The whole file, whatever is in it. */
static inline int gxio_reader_load(gxio_reader *reader, const char *path, gxio_error *error) {
    size_t length = 0;
    memset(reader, 0, sizeof *reader);
    reader->path = path;
    reader->line = reader->token_line = 1;
    errno = 0;
    reader->text = gxio_slurp(path, &length);
    if (!reader->text) return gxio_fail(error, path, 0, "cannot be read: %s", strerror(errno ? errno : EIO));
    reader->at = reader->text;
    reader->end = reader->text + length;
    return 1;
}

/* 1: text, 0: there are bytes of 0 in it, which no text has. */
static inline int gxio_is_text(const gxio_reader *reader) {
    return memchr(reader->text, 0, (size_t)(reader->end - reader->text)) == NULL;
}

static inline int gxio_reader_open(gxio_reader *reader, const char *path, gxio_error *error) {
    if (!gxio_reader_load(reader, path, error)) return 0;
    if (gxio_is_text(reader)) return 1;
    gxio_reader_release(reader);
    return gxio_fail(error, path, 0, "is binary, not text");
}

static inline int gxio_is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

static inline void gxio_skip_line(gxio_reader *reader) {
    while (*reader->at && *reader->at != '\n') reader->at++;
}

static inline void gxio_next_line(gxio_reader *reader) {
    gxio_skip_line(reader);
    if (!*reader->at) return;
    reader->at++;
    reader->line++;
}

/* Length of a backslash at the end of a line with the line's end, behind which an OBJ line goes on; 0: there is none.
 */
static inline size_t gxio_continued(const char *at) {
    return at[0] != '\\' ? 0 : at[1] == '\n' ? 2 : at[1] == '\r' && at[2] == '\n' ? 3 : 0;
}

/* Advances to the next token: text up to a blank, past comments (# to the end of the line).
   Returns 0 where there is none: at the end of the file, or of the line if it must stand on the same one. */
static inline int gxio_next(gxio_reader *reader, int where) {
    for (;;) {
        const char c = *reader->at;
        if (c == '#')
            gxio_skip_line(reader);
        else if (gxio_is_blank(c))
            reader->at++;
        else if (gxio_continued(reader->at)) {
            reader->at += gxio_continued(reader->at);
            reader->line++;
        } else if (c == '\n' && where == GXIO_ANY_LINE) {
            reader->at++;
            reader->line++;
        } else
            break;
    }
    if (!*reader->at || *reader->at == '\n') return 0;
    reader->token = reader->at;
    reader->token_line = reader->line;
    while (*reader->at && *reader->at != '\n' && *reader->at != '#' && !gxio_is_blank(*reader->at) &&
           !gxio_continued(reader->at))
        reader->at++;
    reader->token_length = (size_t)(reader->at - reader->token);
    return 1;
}

static inline int gxio_token_is(const gxio_reader *reader, const char *word) {
    return strlen(word) == reader->token_length && memcmp(word, reader->token, reader->token_length) == 0;
}

/* Fails at the last token: "PATH:LINE: 'token' cause". */
static inline int gxio_bad_token(const gxio_reader *reader, const char *cause, gxio_error *error) {
    const int shown = reader->token_length < 40 ? (int)reader->token_length : 40;
    return gxio_fail(error, reader->path, reader->token_line, "'%.*s' %s", shown, reader->token, cause);
}

/* The next token, or a failure that says what is missing. */
static inline int gxio_need(gxio_reader *reader, int where, const char *what, gxio_error *error) {
    if (gxio_next(reader, where)) return 1;
    if (!*reader->at)
        return gxio_fail(error, reader->path, reader->token_line, "the file ends where %s should stand", what);
    return gxio_fail(error, reader->path, reader->line, "%s is missing", what);
}

/* The next token, which must be `word`. */
static inline int gxio_expect(gxio_reader *reader, const char *word, gxio_error *error) {
    char cause[80];
    if (!gxio_need(reader, GXIO_ANY_LINE, word, error)) return 0;
    if (gxio_token_is(reader, word)) return 1;
    snprintf(cause, sizeof cause, "stands where %s should", word);
    return gxio_bad_token(reader, cause, error);
}

/* A finite double that fills [text, end). Infinities and NaN are recognised by their letters and by errno, never by
   arithmetic, so that -ffast-math can't hide them. */
static inline int gxio_parse_number(const char *text, const char *end, double *value) {
    const char *first = text + (*text == '-' || *text == '+');
    char *stop;
    if (first >= end || !((*first >= '0' && *first <= '9') || *first == '.')) return 0;
    errno = 0;
    *value = strtod(text, &stop);
    return stop == end && !(errno == ERANGE && fabs(*value) > 1.0);
}

/* An integer that fills [text, end), |value| <= 2^53. */
static inline int gxio_parse_integer(const char *text, const char *end, int64_t *value) {
    const int64_t limit = (int64_t)1 << 53;
    const int negative = *text == '-';
    int64_t sum = 0;
    if (*text == '-' || *text == '+') text++;
    if (text >= end) return 0;
    for (; text < end; text++) {
        if (*text < '0' || *text > '9') return 0;
        sum = 10 * sum + (*text - '0');
        if (sum > limit) return 0;
    }
    *value = negative ? -sum : sum;
    return 1;
}

static inline int gxio_read_number(gxio_reader *reader, int where, const char *what, double *value, gxio_error *error) {
    if (!gxio_need(reader, where, what, error)) return 0;
    if (gxio_parse_number(reader->token, reader->token + reader->token_length, value)) return 1;
    return gxio_bad_token(reader, "is not a finite number", error);
}

static inline int gxio_read_integer(gxio_reader *reader, int where, const char *what, int64_t *value,
                                    gxio_error *error) {
    if (!gxio_need(reader, where, what, error)) return 0;
    if (gxio_parse_integer(reader->token, reader->token + reader->token_length, value)) return 1;
    return gxio_bad_token(reader, "is not an integer", error);
}

/* The count of a list. A count that the rest of the file can't hold (two bytes per entry) is refused before anything
   is allocated for it. */
static inline int gxio_read_count(gxio_reader *reader, int where, const char *what, size_t *count, gxio_error *error) {
    int64_t value = 0;
    if (!gxio_read_integer(reader, where, what, &value, error)) return 0;
    if (value < 0) return gxio_bad_token(reader, "is a negative count", error);
    if (value >= (int64_t)UINT32_MAX) return gxio_bad_token(reader, "is too large a count", error);
    if (value > (reader->end - reader->at) / 2 + 1)
        return gxio_bad_token(reader, "is a larger count than the file is long: it is cut off", error);
    *count = (size_t)value;
    return 1;
}

static inline int gxio_read_point(gxio_reader *reader, int where, double point[3], gxio_error *error) {
    return gxio_read_number(reader, where, "a coordinate", &point[0], error) &&
           gxio_read_number(reader, where, "a coordinate", &point[1], error) &&
           gxio_read_number(reader, where, "a coordinate", &point[2], error);
}

/* An index of 0..UINT32_MAX; whether it lies inside its array is checked when the array is complete. */
static inline int gxio_read_index(gxio_reader *reader, int where, uint32_t *index, gxio_error *error) {
    int64_t value = 0;
    if (!gxio_read_integer(reader, where, "an index", &value, error)) return 0;
    if (value < 0 || value > (int64_t)UINT32_MAX) return gxio_bad_token(reader, "is an index out of range", error);
    *index = (uint32_t)value;
    return 1;
}

/* --------------------------------------------------------------------------------------------- >>arguments */

static inline int gxio_argument_number(const char *text, double *value) {
    return gxio_parse_number(text, text + strlen(text), value);
}

/* Reads between `least` and `most` numbers separated by commas. Returns how many, -1 on anything else. */
static inline int gxio_argument_list(const char *text, double *values, int least, int most) {
    int count = 0;
    for (;;) {
        const char *end = text + strcspn(text, ",");
        if (count == most || !gxio_parse_number(text, end, &values[count])) return -1;
        count++;
        if (!*end) return count >= least ? count : -1;
        text = end + 1;
    }
}

static inline int gxio_ends_with(const char *text, const char *ending) {
    const size_t length = strlen(text), tail = strlen(ending);
    return length > tail && strcmp(text + length - tail, ending) == 0;
}

/* What follows `prefix` in text, or NULL. */
static inline const char *gxio_after(const char *text, const char *prefix) {
    const size_t length = strlen(prefix);
    return strncmp(text, prefix, length) == 0 ? text + length : NULL;
}

/* ---------------------------------------------------------------------------------------------- >>mesh */

typedef struct gxio_mesh {
    double *positions; /* node_count x 3 */
    size_t node_count;
    uint32_t *elements; /* element_count x 4 */
    size_t element_count;
    uint32_t *node_lines;    /* node_count, lines of node_path; NULL: generated */
    uint32_t *element_lines; /* element_count, lines of element_path; NULL: generated */
    char node_path[GXIO_PATH_ROOM], element_path[GXIO_PATH_ROOM];
} gxio_mesh;

static inline void gxio_mesh_release(gxio_mesh *mesh) {
    free(mesh->positions);
    free(mesh->elements);
    free(mesh->node_lines);
    free(mesh->element_lines);
    memset(mesh, 0, sizeof *mesh);
}

/* malloc of count x size bytes, never of 0; NULL also where the product overflows. */
static inline void *gxio_array(size_t count, size_t size) {
    if (count > (SIZE_MAX - 1) / size) return NULL;
    return malloc(count ? count * size : 1);
}

static inline int gxio_mesh_nodes(gxio_mesh *mesh, size_t count) {
    mesh->node_count = count;
    mesh->positions = (double *)gxio_array(count, 3 * sizeof(double));
    mesh->node_lines = (uint32_t *)gxio_array(count, sizeof(uint32_t));
    return mesh->positions && mesh->node_lines;
}

static inline int gxio_mesh_elements(gxio_mesh *mesh, size_t count) {
    mesh->element_count = count;
    mesh->elements = (uint32_t *)gxio_array(count, 4 * sizeof(uint32_t));
    mesh->element_lines = (uint32_t *)gxio_array(count, sizeof(uint32_t));
    return mesh->elements && mesh->element_lines;
}

typedef struct gxio_box {
    double low[3], high[3];
} gxio_box; /* m */

static inline void gxio_bounds(const double *points, size_t count, double low[3], double high[3]) {
    size_t i;
    int axis;
    for (axis = 0; axis < 3; axis++) low[axis] = high[axis] = count ? points[axis] : 0.0;
    for (i = 0; i < 3 * count; i++) {
        if (points[i] < low[i % 3]) low[i % 3] = points[i];
        if (points[i] > high[i % 3]) high[i % 3] = points[i];
    }
}

/* The bounding box of the nodes that elements have: files may hold others, which are no part of the body. */
static inline void gxio_mesh_bounds(const gxio_mesh *mesh, double low[3], double high[3]) {
    size_t i;
    int axis;
    for (axis = 0; axis < 3; axis++) low[axis] = high[axis] = 0.0;
    for (i = 0; i < 4 * mesh->element_count; i++)
        for (axis = 0; axis < 3; axis++) {
            const double x = mesh->positions[3 * (size_t)mesh->elements[i] + (size_t)axis];
            if (i == 0 || x < low[axis]) low[axis] = x;
            if (i == 0 || x > high[axis]) high[axis] = x;
        }
}

/* det(x1 - x0, x2 - x0, x3 - x0) in doubles. */
static inline double gxio_element_determinant(const double *positions, const uint32_t *element) {
    double d[3][3];
    int corner, axis;
    for (corner = 0; corner < 3; corner++)
        for (axis = 0; axis < 3; axis++)
            d[corner][axis] =
                positions[3 * element[corner + 1] + (uint32_t)axis] - positions[3 * element[0] + (uint32_t)axis];
    return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
           d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/* Some programs number a tetrahedron's corners the other way round. A file of several elements, none positive and some
   negative, is one of these: its elements are turned. Otherwise (also with one element, which shows no convention) the
   file's order stays, and an inverted element is for the library to refuse. */
static inline void gxio_mesh_orient(gxio_mesh *mesh) {
    size_t e, negative = 0;
    for (e = 0; e < mesh->element_count; e++) {
        const double determinant = gxio_element_determinant(mesh->positions, mesh->elements + 4 * e);
        if (determinant > 0.0) return;
        if (determinant < 0.0) negative++;
    }
    if (!negative || mesh->element_count < 2) return;
    for (e = 0; e < mesh->element_count; e++) {
        uint32_t *corner = mesh->elements + 4 * e, swap = corner[2];
        corner[2] = corner[3];
        corner[3] = swap;
    }
}

/* Subtracts the file's first index (0 or 1) from all corners and checks that each names a node. */
static inline int gxio_mesh_rebase(gxio_mesh *mesh, uint32_t base, gxio_error *error) {
    size_t i;
    for (i = 0; i < 4 * mesh->element_count; i++) {
        const uint32_t index = mesh->elements[i];
        if (index < base || index - base >= mesh->node_count)
            return gxio_fail(error, mesh->element_path, mesh->element_lines[i / 4],
                             "node index %lu is out of range: the nodes are %lu to %lu", (unsigned long)index,
                             (unsigned long)base,
                             (unsigned long)(mesh->node_count + base) - (mesh->node_count ? 1u : 0u));
        mesh->elements[i] = index - base;
    }
    return 1;
}

static inline int gxio_medit_vertices(gxio_reader *reader, gxio_mesh *mesh, gxio_error *error) {
    size_t i, count = 0;
    double reference;
    if (mesh->positions) return gxio_bad_token(reader, "occurs twice", error);
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of vertices", &count, error)) return 0;
    if (!gxio_mesh_nodes(mesh, count)) return gxio_fail(error, reader->path, reader->line, "out of memory");
    for (i = 0; i < count; i++) {
        if (!gxio_read_point(reader, GXIO_ANY_LINE, mesh->positions + 3 * i, error)) return 0;
        mesh->node_lines[i] = (uint32_t)reader->token_line;
        if (!gxio_read_number(reader, GXIO_ANY_LINE, "a vertex's reference", &reference, error)) return 0;
    }
    return 1;
}

static inline int gxio_medit_tetrahedra(gxio_reader *reader, gxio_mesh *mesh, gxio_error *error) {
    size_t i, corner, count = 0;
    double reference;
    if (mesh->elements) return gxio_bad_token(reader, "occurs twice", error);
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of tetrahedra", &count, error)) return 0;
    if (!gxio_mesh_elements(mesh, count)) return gxio_fail(error, reader->path, reader->line, "out of memory");
    for (i = 0; i < count; i++) {
        for (corner = 0; corner < 4; corner++)
            if (!gxio_read_index(reader, GXIO_ANY_LINE, mesh->elements + 4 * i + corner, error)) return 0;
        mesh->element_lines[i] = (uint32_t)reader->token_line;
        if (!gxio_read_number(reader, GXIO_ANY_LINE, "a tetrahedron's reference", &reference, error)) return 0;
    }
    return 1;
}

/* MeshVersionFormatted 1 (float) or 2 (double); the later ones differ in binary files only. */
static inline int gxio_medit_header(gxio_reader *reader, gxio_error *error) {
    int64_t version = 0;
    if (!gxio_need(reader, GXIO_ANY_LINE, "MeshVersionFormatted", error)) return 0;
    if (!gxio_token_is(reader, "MeshVersionFormatted"))
        return gxio_bad_token(reader, "stands where a Medit mesh has MeshVersionFormatted", error);
    if (!gxio_read_integer(reader, GXIO_ANY_LINE, "the format's version", &version, error)) return 0;
    return version >= 1 && version <= 4 ? 1 : gxio_bad_token(reader, "is not a known version of the format", error);
}

static inline int gxio_medit_dimension(gxio_reader *reader, gxio_error *error) {
    int64_t dimension = 0;
    if (!gxio_read_integer(reader, GXIO_ANY_LINE, "the dimension", &dimension, error)) return 0;
    return dimension == 3 ? 1 : gxio_bad_token(reader, "is the dimension, but 3 is needed", error);
}

/* Sections in any order; those not named here are skipped. A missing End is accepted. */
static inline int gxio_medit_sections(gxio_reader *reader, gxio_mesh *mesh, gxio_error *error) {
    int skipping = 0;
    while (gxio_next(reader, GXIO_ANY_LINE)) {
        const char c = *reader->token;
        int good = 1, known = 1;
        if (gxio_token_is(reader, "End"))
            break;
        else if (gxio_token_is(reader, "Dimension"))
            good = gxio_medit_dimension(reader, error);
        else if (gxio_token_is(reader, "Vertices"))
            good = gxio_medit_vertices(reader, mesh, error);
        else if (gxio_token_is(reader, "Tetrahedra"))
            good = gxio_medit_tetrahedra(reader, mesh, error);
        else
            known = 0;
        if (!good) return 0;
        if (known)
            skipping = 0;
        else if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'))
            skipping = 1;
        else if (!skipping)
            return gxio_bad_token(reader, "stands where a section's name should", error);
    }
    if (!mesh->positions) return gxio_fail(error, reader->path, reader->token_line, "the file has no Vertices");
    if (!mesh->elements) return gxio_fail(error, reader->path, reader->token_line, "the file has no Tetrahedra");
    return 1;
}

static inline int gxio_read_medit(const char *path, gxio_mesh *mesh, gxio_error *error) {
    gxio_reader reader;
    int good;
    if (!gxio_reader_open(&reader, path, error)) return 0;
    snprintf(mesh->node_path, sizeof mesh->node_path, "%s", path);
    snprintf(mesh->element_path, sizeof mesh->element_path, "%s", path);
    good = gxio_medit_header(&reader, error) && gxio_medit_sections(&reader, mesh, error);
    gxio_reader_release(&reader);
    return good && gxio_mesh_rebase(mesh, 1, error);
}

/* The number at the head of each of TetGen's lines counts up from the first line's. */
static inline int gxio_tetgen_number(gxio_reader *reader, size_t i, uint32_t *base, gxio_error *error) {
    uint32_t number = 0;
    if (!gxio_read_index(reader, GXIO_ANY_LINE, &number, error)) return 0;
    if (i == 0 && number > 1) return gxio_bad_token(reader, "is the first index, but it must be 0 or 1", error);
    if (i == 0) *base = number;
    if (number == *base + i) return 1;
    return gxio_bad_token(reader, "is out of order: the indices of a list go up by one", error);
}

/* .node: count, 3, attributes, markers; then per line: number, x, y, z and what we do not need. */
static inline int gxio_tetgen_nodes(gxio_reader *reader, gxio_mesh *mesh, uint32_t *base, gxio_error *error) {
    size_t i, count = 0;
    int64_t dimension = 0;
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of nodes", &count, error)) return 0;
    if (!gxio_read_integer(reader, GXIO_SAME_LINE, "the dimension", &dimension, error)) return 0;
    if (dimension != 3) return gxio_bad_token(reader, "is the dimension, but 3 is needed", error);
    gxio_skip_line(reader);
    if (!gxio_mesh_nodes(mesh, count)) return gxio_fail(error, reader->path, reader->line, "out of memory");
    for (i = 0; i < count; i++, gxio_skip_line(reader)) {
        if (!gxio_tetgen_number(reader, i, base, error)) return 0;
        if (!gxio_read_point(reader, GXIO_SAME_LINE, mesh->positions + 3 * i, error)) return 0;
        mesh->node_lines[i] = (uint32_t)reader->token_line;
    }
    return 1;
}

/* .ele: count, corners (4, or 10: the first four count), attributes; then per line: number and corners. */
static inline int gxio_tetgen_elements(gxio_reader *reader, gxio_mesh *mesh, gxio_error *error) {
    size_t i, corner, count = 0;
    int64_t corners = 0;
    uint32_t base = 0;
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of tetrahedra", &count, error)) return 0;
    if (!gxio_read_integer(reader, GXIO_SAME_LINE, "the nodes per tetrahedron", &corners, error)) return 0;
    if (corners != 4 && corners != 10)
        return gxio_bad_token(reader, "nodes per tetrahedron, but 4 or 10 are needed", error);
    gxio_skip_line(reader);
    if (!gxio_mesh_elements(mesh, count)) return gxio_fail(error, reader->path, reader->line, "out of memory");
    for (i = 0; i < count; i++, gxio_skip_line(reader)) {
        if (!gxio_tetgen_number(reader, i, &base, error)) return 0;
        for (corner = 0; corner < 4; corner++)
            if (!gxio_read_index(reader, GXIO_SAME_LINE, mesh->elements + 4 * i + corner, error)) return 0;
        mesh->element_lines[i] = (uint32_t)reader->token_line;
    }
    return 1;
}

/* base_path: without .node and .ele; both are read. */
static inline int gxio_read_tetgen(const char *base_path, size_t length, gxio_mesh *mesh, gxio_error *error) {
    gxio_reader reader;
    uint32_t base = 0;
    int good;
    snprintf(mesh->node_path, sizeof mesh->node_path, "%.*s.node", (int)length, base_path);
    snprintf(mesh->element_path, sizeof mesh->element_path, "%.*s.ele", (int)length, base_path);
    if (!gxio_reader_open(&reader, mesh->node_path, error)) return 0;
    good = gxio_tetgen_nodes(&reader, mesh, &base, error);
    gxio_reader_release(&reader);
    if (!good || !gxio_reader_open(&reader, mesh->element_path, error)) return 0;
    good = gxio_tetgen_elements(&reader, mesh, error);
    gxio_reader_release(&reader);
    return good && gxio_mesh_rebase(mesh, base, error);
}

/* ---------------------------------------------------------------------------------------------- >>gmsh */

typedef struct gxio_tag {
    uint32_t tag, node;
} gxio_tag; /* a node's name in the file, its index */

/* A file while it is read. Elements hold tags until all nodes are known. */
typedef struct gxio_gmsh {
    gxio_reader *reader;
    gxio_mesh *mesh;
    gxio_tag *tags; /* mesh->node_count */
    int version;    /* 2 or 4 */
} gxio_gmsh;

/* Past the line $EndNAME of the section $NAME, which is the last token. */
static inline int gxio_gmsh_skip(gxio_reader *reader, gxio_error *error) {
    const char *name = reader->token + 1;
    const size_t length = reader->token_length - 1, line = reader->token_line;
    while (*reader->at) {
        gxio_next_line(reader);
        if (strncmp(reader->at, "$End", 4) != 0 || strncmp(reader->at + 4, name, length) != 0) continue;
        gxio_next_line(reader);
        return 1;
    }
    return gxio_fail(error, reader->path, line, "the file ends before $End%.*s", length < 40 ? (int)length : 40, name);
}

/* $MeshFormat: version, 0 (ASCII), size of a double. */
static inline int gxio_gmsh_header(gxio_gmsh *file, gxio_error *error) {
    gxio_reader *reader = file->reader;
    double version = 0.0;
    int64_t binary = 0;
    if (!gxio_expect(reader, "$MeshFormat", error)) return 0;
    if (!gxio_read_number(reader, GXIO_ANY_LINE, "the format's version", &version, error)) return 0;
    /* x87: 4.1 has more digits than a double */
    file->version = version >= 2.0 && version < 3.0 ? 2 : version > 4.05 && version < 4.15 ? 4 : 0;
    if (!file->version) return gxio_bad_token(reader, "is the format's version, but 2.2 or 4.1 is needed", error);
    if (!gxio_read_integer(reader, GXIO_SAME_LINE, "the file's type", &binary, error)) return 0;
    if (binary) return gxio_bad_token(reader, "is the file's type, but 0 (ASCII) is needed", error);
    gxio_skip_line(reader);
    return gxio_expect(reader, "$EndMeshFormat", error);
}

static inline int gxio_gmsh_room(gxio_gmsh *file, size_t nodes, gxio_error *error) {
    if (file->mesh->positions)
        return gxio_fail(error, file->reader->path, file->reader->token_line, "a second section $Nodes");
    file->tags = (gxio_tag *)gxio_array(nodes, sizeof *file->tags);
    if (gxio_mesh_nodes(file->mesh, nodes) && file->tags) return 1;
    return gxio_fail(error, file->reader->path, file->reader->line, "out of memory");
}

static inline int gxio_gmsh_tag(gxio_gmsh *file, size_t i, gxio_error *error) {
    file->tags[i].node = (uint32_t)i;
    return gxio_read_index(file->reader, GXIO_ANY_LINE, &file->tags[i].tag, error);
}

/* What follows the coordinates on their line (4.1: those on a curve or surface) is passed over. */
static inline int gxio_gmsh_point(gxio_gmsh *file, size_t i, int where, gxio_error *error) {
    if (!gxio_read_point(file->reader, where, file->mesh->positions + 3 * i, error)) return 0;
    file->mesh->node_lines[i] = (uint32_t)file->reader->token_line;
    gxio_skip_line(file->reader);
    return 1;
}

/* Version 2: count, then tag and coordinates per line. */
static inline int gxio_gmsh_nodes_2(gxio_gmsh *file, gxio_error *error) {
    size_t i, count = 0;
    if (!gxio_read_count(file->reader, GXIO_ANY_LINE, "the number of nodes", &count, error)) return 0;
    if (!gxio_gmsh_room(file, count, error)) return 0;
    for (i = 0; i < count; i++)
        if (!gxio_gmsh_tag(file, i, error) || !gxio_gmsh_point(file, i, GXIO_SAME_LINE, error)) return 0;
    return gxio_expect(file->reader, "$EndNodes", error);
}

/* Version 4, first line of $Nodes and $Elements: number of blocks, of items in all. */
static inline int gxio_gmsh_totals(gxio_gmsh *file, const char *what, size_t *blocks, size_t *total,
                                   gxio_error *error) {
    if (!gxio_read_count(file->reader, GXIO_ANY_LINE, "the number of blocks", blocks, error)) return 0;
    if (!gxio_read_count(file->reader, GXIO_SAME_LINE, what, total, error)) return 0;
    gxio_skip_line(file->reader);
    return 1;
}

/* Version 4, first line of a block: dimension and number of its entity, kind (of elements: their type), count, which
   may be `left` at most. */
static inline int gxio_gmsh_block(gxio_gmsh *file, int64_t *kind, size_t left, size_t *count, gxio_error *error) {
    int64_t dimension = 0, entity = 0;
    if (!gxio_read_integer(file->reader, GXIO_ANY_LINE, "a block's dimension", &dimension, error)) return 0;
    if (!gxio_read_integer(file->reader, GXIO_SAME_LINE, "a block's entity", &entity, error)) return 0;
    if (!gxio_read_integer(file->reader, GXIO_SAME_LINE, "a block's kind", kind, error)) return 0;
    if (!gxio_read_count(file->reader, GXIO_SAME_LINE, "a block's count", count, error)) return 0;
    return *count <= left
             ? 1
             : gxio_bad_token(file->reader, "is a larger count than the section's first line leaves", error);
}

static inline int gxio_gmsh_fewer(gxio_gmsh *file, const char *what, size_t left, gxio_error *error) {
    return gxio_fail(error, file->reader->path, file->reader->token_line,
                     "%lu %s fewer than the section's first line says", (unsigned long)left, what);
}

/* Version 4: blocks of all tags, then all coordinates. */
static inline int gxio_gmsh_nodes_4(gxio_gmsh *file, gxio_error *error) {
    size_t blocks = 0, total = 0, first = 0, count = 0, i;
    int64_t parametric = 0;
    if (!gxio_gmsh_totals(file, "the number of nodes", &blocks, &total, error) || !gxio_gmsh_room(file, total, error))
        return 0;
    for (; blocks > 0; blocks--, first += count) {
        if (!gxio_gmsh_block(file, &parametric, total - first, &count, error)) return 0;
        for (i = 0; i < count; i++)
            if (!gxio_gmsh_tag(file, first + i, error)) return 0;
        for (i = 0; i < count; i++)
            if (!gxio_gmsh_point(file, first + i, GXIO_ANY_LINE, error)) return 0;
    }
    if (first < total) return gxio_gmsh_fewer(file, "nodes", total - first, error);
    return gxio_expect(file->reader, "$EndNodes", error);
}

/* The corners of an element, which come first; only tetrahedra (type 4, or 11 with nodes on the edges) are kept. */
static inline int gxio_gmsh_corners(gxio_gmsh *file, int64_t type, gxio_error *error) {
    gxio_mesh *mesh = file->mesh;
    int corner;
    for (corner = 0; corner < 4 && (type == 4 || type == 11); corner++)
        if (!gxio_read_index(file->reader, GXIO_SAME_LINE, mesh->elements + 4 * mesh->element_count + corner, error))
            return 0;
    if (corner == 4) mesh->element_lines[mesh->element_count++] = (uint32_t)file->reader->token_line;
    gxio_skip_line(file->reader);
    return 1;
}

/* Room for tetrahedra, of which there are none yet. */
static inline int gxio_gmsh_element_room(gxio_gmsh *file, size_t count, gxio_error *error) {
    const gxio_reader *reader = file->reader;
    if (file->mesh->elements) return gxio_fail(error, reader->path, reader->token_line, "a second section $Elements");
    if (!gxio_mesh_elements(file->mesh, count)) return gxio_fail(error, reader->path, reader->line, "out of memory");
    file->mesh->element_count = 0;
    return 1;
}

/* Version 2: count, then per line: number, type, how many tags, these, nodes. */
static inline int gxio_gmsh_elements_2(gxio_gmsh *file, gxio_error *error) {
    gxio_reader *reader = file->reader;
    size_t i, count = 0, tags = 0;
    int64_t number = 0, type = 0, tag = 0;
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of elements", &count, error)) return 0;
    if (!gxio_gmsh_element_room(file, count, error)) return 0;
    for (i = 0; i < count; i++) {
        if (!gxio_read_integer(reader, GXIO_ANY_LINE, "an element's number", &number, error)) return 0;
        if (!gxio_read_integer(reader, GXIO_SAME_LINE, "an element's type", &type, error)) return 0;
        if (!gxio_read_count(reader, GXIO_SAME_LINE, "an element's number of tags", &tags, error)) return 0;
        for (; tags > 0; tags--)
            if (!gxio_read_integer(reader, GXIO_SAME_LINE, "an element's tag", &tag, error)) return 0;
        if (!gxio_gmsh_corners(file, type, error)) return 0;
    }
    return gxio_expect(reader, "$EndElements", error);
}

/* Version 4: blocks of one type, per line: number, nodes. */
static inline int gxio_gmsh_elements_4(gxio_gmsh *file, gxio_error *error) {
    size_t blocks = 0, left = 0, count = 0;
    int64_t type = 0, number = 0;
    if (!gxio_gmsh_totals(file, "the number of elements", &blocks, &left, error)) return 0;
    if (!gxio_gmsh_element_room(file, left, error)) return 0;
    for (; blocks > 0; blocks--) {
        if (!gxio_gmsh_block(file, &type, left, &count, error)) return 0;
        for (left -= count; count > 0; count--) {
            if (!gxio_read_integer(file->reader, GXIO_ANY_LINE, "an element's number", &number, error)) return 0;
            if (!gxio_gmsh_corners(file, type, error)) return 0;
        }
    }
    if (left) return gxio_gmsh_fewer(file, "elements", left, error);
    return gxio_expect(file->reader, "$EndElements", error);
}

/* Sections in any order; those not named here are skipped. */
static inline int gxio_gmsh_sections(gxio_gmsh *file, gxio_error *error) {
    gxio_reader *reader = file->reader;
    while (gxio_next(reader, GXIO_ANY_LINE)) {
        int good;
        if (*reader->token != '$') return gxio_bad_token(reader, "stands where a section $... should", error);
        if (gxio_token_is(reader, "$Nodes"))
            good = file->version == 2 ? gxio_gmsh_nodes_2(file, error) : gxio_gmsh_nodes_4(file, error);
        else if (gxio_token_is(reader, "$Elements"))
            good = file->version == 2 ? gxio_gmsh_elements_2(file, error) : gxio_gmsh_elements_4(file, error);
        else
            good = gxio_gmsh_skip(reader, error);
        if (!good) return 0;
    }
    if (!file->mesh->positions) return gxio_fail(error, reader->path, reader->token_line, "the file has no $Nodes");
    if (!file->mesh->elements) return gxio_fail(error, reader->path, reader->token_line, "the file has no $Elements");
    if (!file->mesh->element_count)
        return gxio_fail(error, reader->path, 0, "the file has no tetrahedra (elements of type 4 or 11)");
    return 1;
}

static inline int gxio_tag_compare(const void *a, const void *b) {
    const gxio_tag *p = (const gxio_tag *)a, *q = (const gxio_tag *)b;
    if (p->tag != q->tag) return p->tag < q->tag ? -1 : 1;
    return p->node < q->node ? -1 : p->node > q->node;
}

/* Replaces tags by the nodes' indices. */
static inline int gxio_gmsh_resolve(gxio_gmsh *file, gxio_error *error) {
    gxio_mesh *mesh = file->mesh;
    gxio_tag *tags = file->tags;
    size_t i;
    qsort(tags, mesh->node_count, sizeof *tags, gxio_tag_compare);
    for (i = 1; i < mesh->node_count; i++)
        if (tags[i].tag == tags[i - 1].tag)
            return gxio_fail(error, mesh->node_path, mesh->node_lines[tags[i].node], "a second node with the tag %lu",
                             (unsigned long)tags[i].tag);
    for (i = 0; i < 4 * mesh->element_count; i++) {
        size_t low = 0, high = mesh->node_count; /* the first tag not below the corner's lies in low ... high */
        while (low < high) {
            const size_t middle = low + (high - low) / 2;
            if (tags[middle].tag < mesh->elements[i])
                low = middle + 1;
            else
                high = middle;
        }
        if (low == mesh->node_count || tags[low].tag != mesh->elements[i])
            return gxio_fail(error, mesh->element_path, mesh->element_lines[i / 4], "there is no node with the tag %lu",
                             (unsigned long)mesh->elements[i]);
        mesh->elements[i] = tags[low].node;
    }
    return 1;
}

static inline int gxio_read_gmsh(const char *path, gxio_mesh *mesh, gxio_error *error) {
    gxio_reader reader;
    gxio_gmsh file;
    int good;
    if (!gxio_reader_open(&reader, path, error)) return 0;
    snprintf(mesh->node_path, sizeof mesh->node_path, "%s", path);
    snprintf(mesh->element_path, sizeof mesh->element_path, "%s", path);
    memset(&file, 0, sizeof file);
    file.reader = &reader;
    file.mesh = mesh;
    good = gxio_gmsh_header(&file, error) && gxio_gmsh_sections(&file, error) && gxio_gmsh_resolve(&file, error);
    free(file.tags);
    gxio_reader_release(&reader);
    return good;
}

/* ----------------------------------------------------------------------------------------------- >>vtk */

/* Cells: lists of point indices, one after the other. */
typedef struct gxio_cells {
    size_t count, index_count;
    uint32_t *start; /* count + 1 */
    uint32_t *index; /* index_count */
    uint32_t *line;  /* count */
} gxio_cells;

/* What is read of a legacy VTK file. */
typedef struct gxio_vtk {
    double *points;        /* point_count x 3; NULL: none yet */
    uint32_t *point_lines; /* point_count */
    size_t point_count;
    gxio_cells cells;  /* CELLS of an unstructured grid, POLYGONS of polydata */
    gxio_cells strips; /* TRIANGLE_STRIPS */
    uint32_t *types;   /* type_count, of cells */
    size_t type_count;
} gxio_vtk;

static inline void gxio_cells_release(gxio_cells *cells) {
    free(cells->start);
    free(cells->index);
    free(cells->line);
}

static inline void gxio_vtk_release(gxio_vtk *vtk) {
    free(vtk->points);
    free(vtk->point_lines);
    free(vtk->types);
    gxio_cells_release(&vtk->cells);
    gxio_cells_release(&vtk->strips);
}

/* "# vtk DataFile Version X.Y", a title, ASCII, DATASET and its kind. */
static inline int gxio_vtk_header(gxio_reader *reader, const char *dataset, gxio_error *error) {
    static const char first[] = "# vtk DataFile Version";
    char cause[80];
    if (strncmp(reader->at, first, sizeof first - 1) != 0)
        return gxio_fail(error, reader->path, 1, "the file does not start with '%s'", first);
    gxio_next_line(reader);
    gxio_next_line(reader);
    if (!gxio_need(reader, GXIO_ANY_LINE, "ASCII", error)) return 0;
    if (!gxio_token_is(reader, "ASCII"))
        return gxio_bad_token(reader, "stands where ASCII should: files of that kind only can be read", error);
    if (!gxio_expect(reader, "DATASET", error) || !gxio_need(reader, GXIO_SAME_LINE, "the kind of dataset", error))
        return 0;
    snprintf(cause, sizeof cause, "is the kind of dataset, but %s is needed", dataset);
    return gxio_token_is(reader, dataset) ? 1 : gxio_bad_token(reader, cause, error);
}

/* POINTS count type, then three numbers each. */
static inline int gxio_vtk_points(gxio_reader *reader, gxio_vtk *vtk, gxio_error *error) {
    size_t i;
    if (vtk->points) return gxio_bad_token(reader, "occurs twice", error);
    if (!gxio_read_count(reader, GXIO_SAME_LINE, "the number of points", &vtk->point_count, error)) return 0;
    if (!gxio_need(reader, GXIO_SAME_LINE, "the type of the coordinates", error)) return 0;
    vtk->points = (double *)gxio_array(vtk->point_count, 3 * sizeof(double));
    vtk->point_lines = (uint32_t *)gxio_array(vtk->point_count, sizeof(uint32_t));
    if (!vtk->points || !vtk->point_lines) return gxio_fail(error, reader->path, reader->line, "out of memory");
    for (i = 0; i < vtk->point_count; i++) {
        if (!gxio_read_point(reader, GXIO_ANY_LINE, vtk->points + 3 * i, error)) return 0;
        vtk->point_lines[i] = (uint32_t)reader->token_line;
    }
    return 1;
}

static inline int gxio_cells_room(gxio_cells *cells, const gxio_reader *reader, gxio_error *error) {
    cells->start = (uint32_t *)gxio_array(cells->count + 1, sizeof(uint32_t));
    cells->index = (uint32_t *)gxio_array(cells->index_count, sizeof(uint32_t));
    cells->line = (uint32_t *)gxio_array(cells->count, sizeof(uint32_t));
    if (!cells->start || !cells->index || !cells->line)
        return gxio_fail(error, reader->path, reader->line, "out of memory");
    cells->start[0] = 0;
    return 1;
}

/* Versions up to 4: per cell its number of points and these. size: of both together. */
static inline int gxio_cells_counted(gxio_reader *reader, gxio_cells *cells, size_t count, size_t size,
                                     gxio_error *error) {
    size_t i, k, points = 0, used = 0;
    if (size < count) return gxio_bad_token(reader, "is a smaller size than the number of cells", error);
    cells->count = count;
    cells->index_count = size - count;
    if (!gxio_cells_room(cells, reader, error)) return 0;
    for (i = 0; i < count; i++) {
        if (!gxio_read_count(reader, GXIO_ANY_LINE, "a cell's number of points", &points, error)) return 0;
        if (points > cells->index_count - used)
            return gxio_bad_token(reader, "points are more than the section's size leaves", error);
        cells->line[i] = (uint32_t)reader->token_line;
        for (k = 0; k < points; k++)
            if (!gxio_read_index(reader, GXIO_ANY_LINE, cells->index + used++, error)) return 0;
        cells->start[i + 1] = (uint32_t)used;
    }
    if (used == cells->index_count) return 1;
    return gxio_fail(error, reader->path, reader->token_line, "the cells end before the section's size is reached");
}

/* Version 5: OFFSETS type, where each cell starts and the last ends; CONNECTIVITY type, points of all. OFFSETS is the
 * last token. */
static inline int gxio_cells_listed(gxio_reader *reader, gxio_cells *cells, size_t offsets, size_t size,
                                    gxio_error *error) {
    size_t i, k;
    cells->count = offsets ? offsets - 1 : 0;
    cells->index_count = size;
    if (!gxio_cells_room(cells, reader, error) || !gxio_need(reader, GXIO_SAME_LINE, "the type of the offsets", error))
        return 0;
    for (i = 0; i < offsets; i++) {
        if (!gxio_read_index(reader, GXIO_ANY_LINE, cells->start + i, error)) return 0;
        if (i ? cells->start[i] < cells->start[i - 1] : cells->start[i] != 0)
            return gxio_bad_token(reader, "is an offset out of order", error);
    }
    if (cells->start[cells->count] != size) return gxio_bad_token(reader, "is not where the last cell ends", error);
    if (!gxio_expect(reader, "CONNECTIVITY", error) ||
        !gxio_need(reader, GXIO_SAME_LINE, "the type of the connectivity", error))
        return 0;
    for (i = 0; i < cells->count; i++)
        for (k = cells->start[i]; k < cells->start[i + 1]; k++) {
            if (!gxio_read_index(reader, GXIO_ANY_LINE, cells->index + k, error)) return 0;
            if (k == cells->start[i]) cells->line[i] = (uint32_t)reader->token_line;
        }
    return 1;
}

/* CELLS, POLYGONS or TRIANGLE_STRIPS, and two numbers. */
static inline int gxio_vtk_cells(gxio_reader *reader, gxio_cells *cells, gxio_error *error) {
    size_t count = 0, size = 0;
    gxio_reader after;
    if (cells->start) return gxio_bad_token(reader, "occurs twice", error);
    if (!gxio_read_count(reader, GXIO_SAME_LINE, "the number of cells", &count, error)) return 0;
    if (!gxio_read_count(reader, GXIO_SAME_LINE, "the size of the cells", &size, error)) return 0;
    after = *reader;
    if (!gxio_next(&after, GXIO_ANY_LINE) || !gxio_token_is(&after, "OFFSETS"))
        return gxio_cells_counted(reader, cells, count, size, error);
    *reader = after;
    return gxio_cells_listed(reader, cells, count, size, error);
}

static inline int gxio_vtk_types(gxio_reader *reader, gxio_vtk *vtk, gxio_error *error) {
    size_t i;
    if (vtk->types) return gxio_bad_token(reader, "occurs twice", error);
    if (!gxio_read_count(reader, GXIO_SAME_LINE, "the number of types", &vtk->type_count, error)) return 0;
    vtk->types = (uint32_t *)gxio_array(vtk->type_count, sizeof(uint32_t));
    if (!vtk->types) return gxio_fail(error, reader->path, reader->line, "out of memory");
    for (i = 0; i < vtk->type_count; i++)
        if (!gxio_read_index(reader, GXIO_ANY_LINE, vtk->types + i, error)) return 0;
    return 1;
}

/* Sections up to the first with data. Those between, which are not needed (METADATA, FIELD, LINES, VERTICES), are
 * skipped. */
static inline int gxio_vtk_sections(gxio_reader *reader, gxio_vtk *vtk, gxio_error *error) {
    int skipping = 0;
    while (gxio_next(reader, GXIO_ANY_LINE)) {
        int good = 1, known = 1;
        if (gxio_token_is(reader, "CELL_DATA") || gxio_token_is(reader, "POINT_DATA"))
            break;
        else if (gxio_token_is(reader, "POINTS"))
            good = gxio_vtk_points(reader, vtk, error);
        else if (gxio_token_is(reader, "CELLS") || gxio_token_is(reader, "POLYGONS"))
            good = gxio_vtk_cells(reader, &vtk->cells, error);
        else if (gxio_token_is(reader, "TRIANGLE_STRIPS"))
            good = gxio_vtk_cells(reader, &vtk->strips, error);
        else if (gxio_token_is(reader, "CELL_TYPES"))
            good = gxio_vtk_types(reader, vtk, error);
        else
            known = 0;
        if (!good) return 0;
        if (known)
            skipping = 0;
        else if (gxio_token_is(reader, "METADATA") || gxio_token_is(reader, "FIELD") ||
                 gxio_token_is(reader, "LINES") || gxio_token_is(reader, "VERTICES"))
            skipping = 1;
        else if (!skipping)
            return gxio_bad_token(reader, "stands where a section's name should", error);
    }
    return vtk->points ? 1 : gxio_fail(error, reader->path, reader->token_line, "the file has no POINTS");
}

/* A whole file whose DATASET is of the kind `dataset`. vtk is to be released, whatever is returned. */
static inline int gxio_vtk_read(const char *path, const char *dataset, gxio_vtk *vtk, gxio_error *error) {
    gxio_reader reader;
    int good;
    memset(vtk, 0, sizeof *vtk);
    if (!gxio_reader_open(&reader, path, error)) return 0;
    good = gxio_vtk_header(&reader, dataset, error) && gxio_vtk_sections(&reader, vtk, error);
    gxio_reader_release(&reader);
    return good;
}

/* The cells of type 10 (VTK_TETRA) and the corners of those of type 24 (VTK_QUADRATIC_TETRA); others are left out. */
static inline int gxio_vtk_tetrahedra(const gxio_vtk *vtk, gxio_mesh *mesh, gxio_error *error) {
    const gxio_cells *cells = &vtk->cells;
    size_t i;
    if (!cells->start) return gxio_fail(error, mesh->element_path, 0, "the file has no CELLS");
    if (vtk->type_count != cells->count)
        return gxio_fail(error, mesh->element_path, 0, "the file has %lu CELLS, but %lu CELL_TYPES",
                         (unsigned long)cells->count, (unsigned long)vtk->type_count);
    if (!gxio_mesh_elements(mesh, cells->count)) return gxio_fail(error, mesh->element_path, 0, "out of memory");
    mesh->element_count = 0;
    for (i = 0; i < cells->count; i++) {
        const uint32_t points = cells->start[i + 1] - cells->start[i], type = vtk->types[i];
        if (type != 10 && type != 24) continue;
        if (points != (type == 10 ? 4 : 10))
            return gxio_fail(error, mesh->element_path, cells->line[i], "a cell of type %lu with %lu points",
                             (unsigned long)type, (unsigned long)points);
        memcpy(mesh->elements + 4 * mesh->element_count, cells->index + cells->start[i], 4 * sizeof(uint32_t));
        mesh->element_lines[mesh->element_count++] = cells->line[i];
    }
    return mesh->element_count
             ? 1
             : gxio_fail(error, mesh->element_path, 0, "the file has no tetrahedra (cells of type 10 or 24)");
}

static inline int gxio_read_vtk_mesh(const char *path, gxio_mesh *mesh, gxio_error *error) {
    gxio_vtk vtk;
    int good = gxio_vtk_read(path, "UNSTRUCTURED_GRID", &vtk, error);
    snprintf(mesh->node_path, sizeof mesh->node_path, "%s", path);
    snprintf(mesh->element_path, sizeof mesh->element_path, "%s", path);
    if (good) {
        mesh->positions = vtk.points;
        mesh->node_lines = vtk.point_lines;
        mesh->node_count = vtk.point_count;
        vtk.points = NULL;
        vtk.point_lines = NULL;
        good = gxio_vtk_tetrahedra(&vtk, mesh, error) && gxio_mesh_rebase(mesh, 0, error);
    }
    gxio_vtk_release(&vtk);
    return good;
}

/* ------------------------------------------------------------------------------------------ >>generate */

/* A unit cube with lowest corner `node[0]` as five or six tetrahedra; node[b] is the corner x + 2 y + 4 z = b. The five
   are mirrored in every second cube (`odd`), the six are Kuhn's: both ways neighbouring cubes' faces agree. */
static inline uint32_t *gxio_fill_cube(const uint32_t node[8], int tetrahedra, int odd, uint32_t *element) {
    /* clang-format off */
    static const unsigned char cube[3][6][4] = {
        {{0, 5, 3, 6}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 6, 5, 0}, {7, 5, 6, 3}, {0, 0, 0, 0}},
        {{7, 2, 1, 4}, {6, 4, 2, 7}, {5, 7, 1, 4}, {3, 1, 7, 2}, {0, 2, 4, 1}, {0, 0, 0, 0}},
        {{0, 1, 3, 7}, {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 6, 4, 7}}};
    /* clang-format on */
    const int kind = tetrahedra == 6 ? 2 : odd;
    int t, corner;
    for (t = 0; t < tetrahedra; t++)
        for (corner = 0; corner < 4; corner++) *element++ = node[cube[kind][t][corner]];
    return element;
}

/* Cubes of edge 1 with the lowest corner at the origin; node x + (nx + 1)(y + (ny + 1) z). */
static inline int gxio_make_grid(gxio_mesh *mesh, const size_t n[3], int tetrahedra) {
    const size_t row = n[0] + 1, layer = row * (n[1] + 1);
    size_t i, x, y, z;
    uint32_t *element;
    if (!gxio_mesh_nodes(mesh, layer * (n[2] + 1))) return 0;
    if (!gxio_mesh_elements(mesh, n[0] * n[1] * n[2] * (size_t)tetrahedra)) return 0;
    for (i = 0; i < mesh->node_count; i++) {
        mesh->positions[3 * i] = (double)(i % row);
        mesh->positions[3 * i + 1] = (double)(i / row % (n[1] + 1));
        mesh->positions[3 * i + 2] = (double)(i / layer);
    }
    element = mesh->elements;
    for (z = 0; z < n[2]; z++)
        for (y = 0; y < n[1]; y++)
            for (x = 0; x < n[0]; x++) {
                uint32_t node[8];
                for (i = 0; i < 8; i++)
                    node[i] = (uint32_t)(x + (i & 1) + row * (y + (i >> 1 & 1)) + layer * (z + (i >> 2)));
                element = gxio_fill_cube(node, tetrahedra, (int)((x + y + z) & 1), element);
            }
    return 1;
}

/* grid:NX,NY,NZ[,5|6] */
static inline int gxio_generate_grid(const char *spec, const char *list, gxio_mesh *mesh, gxio_error *error) {
    double number[4] = {0, 0, 0, 5};
    size_t n[3];
    int axis, good = gxio_argument_list(list, number, 3, 4) > 0 && (number[3] == 5.0 || number[3] == 6.0);
    for (axis = 0; axis < 3; axis++)
        good = good && number[axis] >= 1.0 && number[axis] <= 1e6 && floor(number[axis]) == number[axis];
    if (!good) return gxio_fail(error, spec, 0, "is not grid:NX,NY,NZ or grid:NX,NY,NZ,5 or grid:NX,NY,NZ,6");
    if (number[0] * number[1] * number[2] > 1e8) return gxio_fail(error, spec, 0, "has more than 10^8 cubes");
    for (axis = 0; axis < 3; axis++) n[axis] = (size_t)number[axis];
    return gxio_make_grid(mesh, n, (int)number[3]) ? 1 : gxio_fail(error, spec, 0, "out of memory");
}

/* tet: the reference tetrahedron, corners at the origin and at 1 on each axis. */
static inline int gxio_generate_tet(gxio_mesh *mesh, gxio_error *error) {
    static const double position[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t corner[4] = {0, 1, 2, 3};
    if (!gxio_mesh_nodes(mesh, 4) || !gxio_mesh_elements(mesh, 1)) return gxio_fail(error, "tet", 0, "out of memory");
    memcpy(mesh->positions, position, sizeof position);
    memcpy(mesh->elements, corner, sizeof corner);
    return 1;
}

/* Takes over what gxshape.h made; fails if it says what is wrong. */
static inline int gxio_take_shape(const char *spec, const char *wrong, const gxshape_mesh *made, gxio_mesh *mesh,
                                  gxio_error *error) {
    if (wrong) return gxio_fail(error, spec, 0, "%s", wrong);
    mesh->positions = made->positions;
    mesh->node_count = made->node_count;
    mesh->elements = made->elements;
    mesh->element_count = made->element_count;
    return 1;
}

/* ball:RADIUS,SPACING and torus:R,r,SPACING about the origin, the torus around the z axis. */
static inline int gxio_generate_round(const char *spec, gxio_mesh *mesh, gxio_error *error) {
    const char *ball = gxio_after(spec, "ball:");
    double number[3] = {0, 0, 0}, thin;
    gxshape_mesh made;
    gxshape_field field;
    int count =
        ball ? gxio_argument_list(ball, number, 2, 2) : gxio_argument_list(spec + strlen("torus:"), number, 3, 3);
    memset(&field, 0, sizeof field);
    field.part_count = 1;
    field.parts[0].kind = ball ? GXSHAPE_CAPSULE : GXSHAPE_RING;
    field.parts[0].q[2] = ball ? 0.0 : 1.0;
    field.parts[0].r[0] = number[0];
    field.parts[0].r[1] = thin = ball ? number[0] : number[1];
    if (count < 0 || !(number[count - 1] > 0.0) || !(thin >= GXSHAPE_THINNEST * number[count - 1]) ||
        (!ball && !(number[0] > thin)))
        return gxio_fail(error, spec, 0,
                         ball ? "is not ball:RADIUS,SPACING with 0 < SPACING <= RADIUS / 0.92"
                              : "is not torus:R,r,SPACING with R > r and 0 < SPACING <= r / 0.92");
    return gxio_take_shape(spec, gxshape_fill(&field, number[count - 1], &made), &made, mesh, error);
}

/* NAME or NAME:SPACING of one of gxshape.h's shapes. */
static inline int gxio_generate_shape(const char *spec, const gxshape_named *named, gxio_mesh *mesh,
                                      gxio_error *error) {
    const char *list = strchr(spec, ':');
    double spacing = named->spacing;
    gxshape_mesh made;
    gxshape_field field;
    if (list && (!gxio_argument_number(list + 1, &spacing) || !(spacing > 0.0 && spacing <= named->coarsest)))
        return gxio_fail(error, spec, 0, "is not %s or %s:SPACING with 0 < SPACING <= %g", named->name, named->name,
                         named->coarsest);
    memset(&field, 0, sizeof field);
    named->make(&field);
    return gxio_take_shape(spec, gxshape_fill(&field, spacing, &made), &made, mesh, error);
}

static inline int gxio_mesh_generate(const char *spec, gxio_mesh *mesh, gxio_error *error) {
    static const size_t one[3] = {1, 1, 1};
    const char *list = gxio_after(spec, "grid:");
    const gxshape_named *named = gxshape_find(spec, strcspn(spec, ":"));
    int good;
    if (list)
        good = gxio_generate_grid(spec, list, mesh, error);
    else if (named)
        good = gxio_generate_shape(spec, named, mesh, error);
    else if (gxio_after(spec, "ball:") || gxio_after(spec, "torus:"))
        good = gxio_generate_round(spec, mesh, error);
    else if (strcmp(spec, "tet") == 0)
        good = gxio_generate_tet(mesh, error);
    else
        good = gxio_make_grid(mesh, one, 5) ? 1 : gxio_fail(error, spec, 0, "out of memory");
    free(mesh->node_lines);
    free(mesh->element_lines);
    mesh->node_lines = mesh->element_lines = NULL;
    snprintf(mesh->node_path, sizeof mesh->node_path, "%s", spec);
    snprintf(mesh->element_path, sizeof mesh->element_path, "%s", spec);
    return good;
}

static inline int gxio_mesh_is_generated(const char *spec) {
    return strcmp(spec, "cube5") == 0 || strcmp(spec, "tet") == 0 || gxio_after(spec, "grid:") ||
           gxio_after(spec, "ball:") || gxio_after(spec, "torus:") || gxshape_find(spec, strcspn(spec, ":"));
}

static inline int gxio_mesh_read(const char *path, gxio_mesh *mesh, gxio_error *error) {
    const size_t length = strlen(path);
    int good;
    if (gxio_ends_with(path, ".mesh"))
        good = gxio_read_medit(path, mesh, error);
    else if (gxio_ends_with(path, ".msh"))
        good = gxio_read_gmsh(path, mesh, error);
    else if (gxio_ends_with(path, ".vtk"))
        good = gxio_read_vtk_mesh(path, mesh, error);
    else if (gxio_ends_with(path, ".node"))
        good = gxio_read_tetgen(path, length - 5, mesh, error);
    else if (gxio_ends_with(path, ".ele"))
        good = gxio_read_tetgen(path, length - 4, mesh, error);
    else
        good = gxio_read_tetgen(path, length, mesh, error);
    if (good) gxio_mesh_orient(mesh);
    return good;
}

/* cube5, tet, grid:..., a shape, a .mesh, .msh or .vtk file, a .node or .ele file, or the name that a .node and an .ele
 * file share. */
static inline int gxio_mesh_load(const char *spec, gxio_mesh *mesh, gxio_error *error) {
    int good;
    memset(mesh, 0, sizeof *mesh);
    if (strlen(spec) + 8 > GXIO_PATH_ROOM) return gxio_fail(error, "mesh", 0, "the name is too long");
    if (gxio_mesh_is_generated(spec))
        good = gxio_mesh_generate(spec, mesh, error);
    else
        good = gxio_mesh_read(spec, mesh, error);
    if (!good) gxio_mesh_release(mesh);
    return good;
}

/* -------------------------------------------------------------------------------------------- >>surface */

typedef struct gxio_surface {
    double *vertices; /* vertex_count x 3 */
    size_t vertex_count, vertex_room;
    uint32_t *triangles;      /* triangle_count x 3 */
    uint32_t *triangle_lines; /* triangle_count; 0: generated */
    size_t triangle_count, triangle_room;
} gxio_surface;

static inline void gxio_surface_release(gxio_surface *surface) {
    free(surface->vertices);
    free(surface->triangles);
    free(surface->triangle_lines);
    memset(surface, 0, sizeof *surface);
}

static inline int gxio_add_vertex(gxio_surface *surface, double x, double y, double z) {
    double *vertex;
    if (surface->vertex_count == surface->vertex_room) {
        const size_t room = surface->vertex_room ? 2 * surface->vertex_room : 64;
        double *grown = (double *)realloc(surface->vertices, room * 3 * sizeof(double));
        if (!grown) return 0;
        surface->vertices = grown;
        surface->vertex_room = room;
    }
    vertex = surface->vertices + 3 * surface->vertex_count++;
    vertex[0] = x;
    vertex[1] = y;
    vertex[2] = z;
    return 1;
}

static inline int gxio_grow_triangles(gxio_surface *surface) {
    const size_t room = surface->triangle_room ? 2 * surface->triangle_room : 64;
    uint32_t *triangles = (uint32_t *)realloc(surface->triangles, room * 3 * sizeof(uint32_t)), *lines;
    if (!triangles) return 0;
    surface->triangles = triangles;
    lines = (uint32_t *)realloc(surface->triangle_lines, room * sizeof(uint32_t));
    if (!lines) return 0;
    surface->triangle_lines = lines;
    surface->triangle_room = room;
    return 1;
}

static inline int gxio_add_triangle(gxio_surface *surface, uint32_t a, uint32_t b, uint32_t c, size_t line) {
    uint32_t *triangle;
    if (surface->triangle_count == surface->triangle_room && !gxio_grow_triangles(surface)) return 0;
    surface->triangle_lines[surface->triangle_count] = (uint32_t)line;
    triangle = surface->triangles + 3 * surface->triangle_count++;
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    return 1;
}

static inline int gxio_surface_check(const gxio_surface *surface, const char *path, gxio_error *error) {
    size_t i;
    for (i = 0; i < 3 * surface->triangle_count; i++)
        if (surface->triangles[i] >= surface->vertex_count)
            return gxio_fail(error, path, surface->triangle_lines[i / 3],
                             "vertex index %lu is out of range: the file has %lu vertices",
                             (unsigned long)surface->triangles[i], (unsigned long)surface->vertex_count);
    return 1;
}

/* One corner of an OBJ face: v, v/vt, v//vn or v/vt/vn; v counts from 1, or back from the last vertex if negative. */
static inline int gxio_obj_corner(gxio_reader *reader, const gxio_surface *surface, uint32_t *corner,
                                  gxio_error *error) {
    const char *end = reader->token;
    int64_t v = 0;
    while (end < reader->token + reader->token_length && *end != '/') end++;
    if (!gxio_parse_integer(reader->token, end, &v)) return gxio_bad_token(reader, "is not a face's corner", error);
    v = v < 0 ? v + (int64_t)surface->vertex_count : v - 1;
    if (v < 0 || v >= (int64_t)UINT32_MAX) return gxio_bad_token(reader, "is an index out of range", error);
    *corner = (uint32_t)v;
    return 1;
}

/* A polygon becomes a fan of triangles around its first corner. */
static inline int gxio_obj_face(gxio_reader *reader, gxio_surface *surface, gxio_error *error) {
    uint32_t first = 0, last = 0, corner = 0;
    size_t count = 0;
    while (gxio_next(reader, GXIO_SAME_LINE)) {
        if (!gxio_obj_corner(reader, surface, &corner, error)) return 0;
        if (count >= 2 && !gxio_add_triangle(surface, first, last, corner, reader->token_line))
            return gxio_fail(error, reader->path, reader->line, "out of memory");
        if (count == 0) first = corner;
        last = corner;
        count++;
    }
    return count >= 3 ? 1 : gxio_fail(error, reader->path, reader->line, "the face has fewer than three corners");
}

/* Lines v and f; all others are ignored. */
static inline int gxio_read_obj(gxio_reader *reader, gxio_surface *surface, gxio_error *error) {
    double p[3] = {0, 0, 0};
    for (; gxio_next(reader, GXIO_ANY_LINE); gxio_skip_line(reader)) {
        if (gxio_token_is(reader, "v")) {
            if (!gxio_read_point(reader, GXIO_SAME_LINE, p, error)) return 0;
            if (!gxio_add_vertex(surface, p[0], p[1], p[2]))
                return gxio_fail(error, reader->path, reader->line, "out of memory");
        } else if (gxio_token_is(reader, "f")) {
            if (!gxio_obj_face(reader, surface, error)) return 0;
        }
    }
    return 1;
}

static inline int gxio_off_face(gxio_reader *reader, gxio_surface *surface, gxio_error *error) {
    uint32_t first = 0, last = 0, corner = 0, corners = 0, i;
    if (!gxio_read_index(reader, GXIO_ANY_LINE, &corners, error)) return 0;
    if (corners < 3) return gxio_bad_token(reader, "corners are too few for a face", error);
    for (i = 0; i < corners; i++) {
        if (!gxio_read_index(reader, GXIO_SAME_LINE, &corner, error)) return 0;
        if (i >= 2 && !gxio_add_triangle(surface, first, last, corner, reader->token_line))
            return gxio_fail(error, reader->path, reader->line, "out of memory");
        if (i == 0) first = corner;
        last = corner;
    }
    return 1;
}

/* [OFF] vertices faces edges, then a vertex or a face per line; colours and normals behind them are ignored. */
static inline int gxio_read_off(gxio_reader *reader, gxio_surface *surface, gxio_error *error) {
    size_t i, vertices = 0, faces = 0;
    double p[3] = {0, 0, 0};
    if (!gxio_need(reader, GXIO_ANY_LINE, "OFF", error)) return 0;
    if (!gxio_token_is(reader, "OFF") && !gxio_token_is(reader, "COFF") && !gxio_token_is(reader, "NOFF")) {
        if (*reader->token < '0' || *reader->token > '9')
            return gxio_bad_token(reader, "stands where OFF should", error);
        reader->at = reader->token;
    }
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of vertices", &vertices, error)) return 0;
    if (!gxio_read_count(reader, GXIO_ANY_LINE, "the number of faces", &faces, error)) return 0;
    for (i = 0, gxio_skip_line(reader); i < vertices; i++, gxio_skip_line(reader)) {
        if (!gxio_read_point(reader, GXIO_ANY_LINE, p, error)) return 0;
        if (!gxio_add_vertex(surface, p[0], p[1], p[2]))
            return gxio_fail(error, reader->path, reader->line, "out of memory");
    }
    for (i = 0; i < faces; i++, gxio_skip_line(reader))
        if (!gxio_off_face(reader, surface, error)) return 0;
    return 1;
}

/* Polygons as fans around their first corner, strips with every second triangle turned. */
static inline int gxio_vtk_triangles(const char *path, const gxio_vtk *vtk, gxio_surface *surface, gxio_error *error) {
    const uint32_t *at;
    size_t i, k;
    int good = 1;
    if (!vtk->cells.start && !vtk->strips.start)
        return gxio_fail(error, path, 0, "the file has neither POLYGONS nor TRIANGLE_STRIPS");
    for (i = 0; i < vtk->point_count && good; i++)
        good = gxio_add_vertex(surface, vtk->points[3 * i], vtk->points[3 * i + 1], vtk->points[3 * i + 2]);
    for (i = 0; i < vtk->cells.count && good; i++) {
        at = vtk->cells.index + vtk->cells.start[i];
        for (k = 2; k < vtk->cells.start[i + 1] - vtk->cells.start[i] && good; k++)
            good = gxio_add_triangle(surface, at[0], at[k - 1], at[k], vtk->cells.line[i]);
    }
    for (i = 0; i < vtk->strips.count && good; i++) {
        at = vtk->strips.index + vtk->strips.start[i];
        for (k = 2; k < vtk->strips.start[i + 1] - vtk->strips.start[i] && good; k++)
            good = gxio_add_triangle(surface, at[k - 2], at[k % 2 ? k : k - 1], at[k % 2 ? k - 1 : k],
                                     vtk->strips.line[i]);
    }
    return good ? 1 : gxio_fail(error, path, 0, "out of memory");
}

static inline int gxio_read_vtk_surface(const char *path, gxio_surface *surface, gxio_error *error) {
    gxio_vtk vtk;
    const int good = gxio_vtk_read(path, "POLYDATA", &vtk, error) && gxio_vtk_triangles(path, &vtk, surface, error);
    gxio_vtk_release(&vtk);
    return good;
}

/* One facet of an ASCII STL file, whose word "facet" is the last token; its normal is not needed. */
static inline int gxio_stl_facet(gxio_reader *reader, gxio_surface *surface, gxio_error *error) {
    const uint32_t first = (uint32_t)surface->vertex_count;
    const size_t line = reader->token_line;
    double p[3] = {0, 0, 0};
    int i;
    gxio_skip_line(reader);
    if (!gxio_expect(reader, "outer", error) || !gxio_expect(reader, "loop", error)) return 0;
    for (i = 0; i < 3; i++) {
        if (!gxio_expect(reader, "vertex", error) || !gxio_read_point(reader, GXIO_SAME_LINE, p, error)) return 0;
        if (!gxio_add_vertex(surface, p[0], p[1], p[2]))
            return gxio_fail(error, reader->path, reader->line, "out of memory");
    }
    if (!gxio_expect(reader, "endloop", error) || !gxio_expect(reader, "endfacet", error)) return 0;
    return gxio_add_triangle(surface, first, first + 1, first + 2, line)
             ? 1
             : gxio_fail(error, reader->path, reader->line, "out of memory");
}

/* Any number of: solid NAME, facets, endsolid NAME. */
static inline int gxio_stl_text(gxio_reader *reader, gxio_surface *surface, gxio_error *error) {
    if (!gxio_need(reader, GXIO_ANY_LINE, "solid", error)) return 0;
    do {
        if (!gxio_token_is(reader, "solid")) return gxio_bad_token(reader, "stands where solid should", error);
        for (gxio_skip_line(reader);;) {
            if (!gxio_need(reader, GXIO_ANY_LINE, "facet or endsolid", error)) return 0;
            if (gxio_token_is(reader, "endsolid")) break;
            if (!gxio_token_is(reader, "facet"))
                return gxio_bad_token(reader, "stands where facet or endsolid should", error);
            if (!gxio_stl_facet(reader, surface, error)) return 0;
        }
        gxio_skip_line(reader);
    } while (gxio_next(reader, GXIO_ANY_LINE));
    return 1;
}

/* Four bytes, the lowest first. */
static inline uint32_t gxio_word(const char *bytes) {
    const unsigned char *b = (const unsigned char *)bytes;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* Binary STL: 80 bytes, the number of triangles, then for each 12 floats (normal, corners) and two bytes. */
enum { GXIO_STL_HEAD = 84, GXIO_STL_TRIANGLE = 50 };

static inline int gxio_stl_is_binary(const char *bytes, size_t length) {
    return length >= GXIO_STL_HEAD && (length - GXIO_STL_HEAD) % GXIO_STL_TRIANGLE == 0 &&
           (length - GXIO_STL_HEAD) / GXIO_STL_TRIANGLE == gxio_word(bytes + GXIO_STL_HEAD - 4);
}

/* A float that is not finite has all bits of its exponent set. */
static inline int gxio_stl_binary(const char *path, const char *bytes, size_t length, gxio_surface *surface,
                                  gxio_error *error) {
    size_t i, count = (length - GXIO_STL_HEAD) / GXIO_STL_TRIANGLE;
    for (i = 0; i < count; i++) {
        const uint32_t first = (uint32_t)surface->vertex_count;
        const char *at = bytes + GXIO_STL_HEAD + i * GXIO_STL_TRIANGLE + 12;
        float x[9];
        int k;
        for (k = 0; k < 9; k++) {
            const uint32_t word = gxio_word(at + 4 * k);
            if ((word >> 23 & 255) == 255)
                return gxio_fail(error, path, 0, "triangle %lu has a coordinate that is not finite", (unsigned long)i);
            memcpy(&x[k], &word, sizeof word);
        }
        for (k = 0; k < 9; k += 3)
            if (!gxio_add_vertex(surface, (double)x[k], (double)x[k + 1], (double)x[k + 2]))
                return gxio_fail(error, path, 0, "out of memory");
        if (!gxio_add_triangle(surface, first, first + 1, first + 2, 0))
            return gxio_fail(error, path, 0, "out of memory");
    }
    return 1;
}

typedef struct gxio_corner {
    double x[3];
    uint32_t vertex;
} gxio_corner;

/* By coordinates; 0 and -0 are equal. */
static inline int gxio_point_compare(const double x[3], const double y[3]) {
    int i;
    for (i = 0; i < 3; i++)
        if (x[i] < y[i] || x[i] > y[i]) return x[i] < y[i] ? -1 : 1;
    return 0;
}

static inline int gxio_corner_compare(const void *a, const void *b) {
    const gxio_corner *p = (const gxio_corner *)a, *q = (const gxio_corner *)b;
    const int order = gxio_point_compare(p->x, q->x);
    return order ? order : p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

/* first[i]: the first vertex with the coordinates of i. corners: room for all vertices. */
static inline void gxio_find_first(const gxio_surface *surface, gxio_corner *corners, uint32_t *first) {
    const size_t count = surface->vertex_count;
    size_t i, start = 0;
    for (i = 0; i < count; i++) {
        memcpy(corners[i].x, surface->vertices + 3 * i, sizeof corners[i].x);
        corners[i].vertex = (uint32_t)i;
    }
    qsort(corners, count, sizeof *corners, gxio_corner_compare);
    for (i = 0; i < count; i++) {
        if (gxio_point_compare(corners[i].x, corners[start].x) != 0) start = i;
        first[corners[i].vertex] = corners[start].vertex;
    }
}

/* Makes one vertex of all with equal coordinates, in the order of the first ones. */
static inline int gxio_surface_merge(gxio_surface *surface) {
    const size_t count = surface->vertex_count;
    gxio_corner *corners = (gxio_corner *)gxio_array(count, sizeof *corners);
    uint32_t *name = (uint32_t *)gxio_array(count, sizeof *name);
    const int good = corners && name;
    size_t i, kept = 0;
    if (good) gxio_find_first(surface, corners, name);
    for (i = 0; i < count && good; i++) { /* name: of those before i, the new number */
        if (name[i] != i) {
            name[i] = name[name[i]];
            continue;
        }
        memmove(surface->vertices + 3 * kept, surface->vertices + 3 * i, 3 * sizeof(double));
        name[i] = (uint32_t)kept++;
    }
    for (i = 0; i < 3 * surface->triangle_count && good; i++) surface->triangles[i] = name[surface->triangles[i]];
    if (good) surface->vertex_count = kept;
    free(corners);
    free(name);
    return good;
}

static inline int gxio_read_stl(const char *path, gxio_surface *surface, gxio_error *error) {
    gxio_reader reader;
    size_t length;
    int good;
    if (!gxio_reader_load(&reader, path, error)) return 0;
    length = (size_t)(reader.end - reader.text);
    if (gxio_stl_is_binary(reader.text, length))
        good = gxio_stl_binary(path, reader.text, length, surface, error);
    else if (gxio_is_text(&reader))
        good = gxio_stl_text(&reader, surface, error);
    else
        good = gxio_fail(error, path, 0, "is binary, but not as long as its number of triangles asks for");
    gxio_reader_release(&reader);
    return good && !gxio_surface_merge(surface) ? gxio_fail(error, path, 0, "out of memory") : good;
}

static inline int gxio_read_obj_or_off(const char *path, gxio_surface *surface, gxio_error *error) {
    gxio_reader reader;
    int good;
    if (!gxio_reader_open(&reader, path, error)) return 0;
    good =
        gxio_ends_with(path, ".obj") ? gxio_read_obj(&reader, surface, error) : gxio_read_off(&reader, surface, error);
    gxio_reader_release(&reader);
    return good;
}

static inline int gxio_surface_read(const char *path, gxio_surface *surface, gxio_error *error) {
    int good;
    if (gxio_ends_with(path, ".obj") || gxio_ends_with(path, ".off"))
        good = gxio_read_obj_or_off(path, surface, error);
    else if (gxio_ends_with(path, ".stl"))
        good = gxio_read_stl(path, surface, error);
    else if (gxio_ends_with(path, ".vtk"))
        good = gxio_read_vtk_surface(path, surface, error);
    else
        return gxio_fail(error, path, 0, "is no cut: .obj, .off, .stl, .vtk, plane:..., box:... or wave:... is");
    return good && gxio_surface_check(surface, path, error);
}

/* A plane with a frame, and where a body lies on it. */
typedef struct gxio_frame {
    double p[3];             /* the plane's given point */
    double u[3], v[3], n[3]; /* orthonormal, n = u x v */
    double at[2];            /* centre of the body's bounding box along u and v, from p */
    double radius;           /* of the ball around the bounding box */
} gxio_frame;

/* Unit vector along d, scaled first so that nothing overflows; 0 where d is 0. Zero components stay exactly zero. */
static inline int gxio_normalise(double d[3]) {
    const double largest = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2])));
    double length;
    int i;
    if (!(largest > 0.0)) return 0;
    for (i = 0; i < 3; i++) d[i] /= largest;
    length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (i = 0; i < 3; i++) d[i] /= length;
    return 1;
}

/* u is the coordinate axis closest to the plane (the first of equals), projected onto it: with n along an axis, u and v
   are axes too, with exact zeros, so that every vertex has exactly p's coordinate along n. */
static inline int gxio_frame_make(gxio_frame *frame, const double point[3], const double normal[3],
                                  const gxio_box *body) {
    double square = 0.0;
    int i, axis = 0;
    memcpy(frame->p, point, sizeof frame->p);
    memcpy(frame->n, normal, sizeof frame->n);
    if (!gxio_normalise(frame->n)) return 0;
    for (i = 1; i < 3; i++)
        if (fabs(frame->n[i]) < fabs(frame->n[axis])) axis = i;
    for (i = 0; i < 3; i++) frame->u[i] = (i == axis ? 1.0 : 0.0) - frame->n[i] * frame->n[axis];
    gxio_normalise(frame->u);
    for (i = 0; i < 3; i++)
        frame->v[i] = frame->n[(i + 1) % 3] * frame->u[(i + 2) % 3] - frame->n[(i + 2) % 3] * frame->u[(i + 1) % 3];
    frame->at[0] = frame->at[1] = 0.0;
    for (i = 0; i < 3; i++) {
        const double offset = 0.5 * (body->low[i] + body->high[i]) - point[i];
        frame->at[0] += offset * frame->u[i];
        frame->at[1] += offset * frame->v[i];
        square += (body->high[i] - body->low[i]) * (body->high[i] - body->low[i]);
    }
    frame->radius = 0.5 * sqrt(square);
    return frame->radius > 0.0;
}

/* The vertex p + a u + b v + h n. */
static inline int gxio_frame_vertex(const gxio_frame *frame, double a, double b, double h, gxio_surface *surface) {
    double x[3];
    int i;
    for (i = 0; i < 3; i++) x[i] = frame->p[i] + (a * frame->u[i] + b * frame->v[i] + h * frame->n[i]);
    return gxio_add_vertex(surface, x[0], x[1], x[2]);
}

/* plane:PX,PY,PZ,NX,NY,NZ: a square that covers the body's shadow on the plane through P with normal N. Its diagonal,
   at which rounding makes a crease if N is oblique, passes beside the body: the body's ball lies in the first triangle,
   whose inscribed circle has the radius edge (1 - 1/sqrt 2) = 1.1 ball radii. */
static inline int gxio_generate_plane(const double number[6], const gxio_box *body, gxio_surface *surface) {
    const double inscribed = 1.1, edge = 3.7556; /* in ball radii */
    gxio_frame frame;
    double a0, b0, a1, b1;
    if (!gxio_frame_make(&frame, number, number + 3, body)) return 0;
    a0 = frame.at[0] - inscribed * frame.radius;
    b0 = frame.at[1] - inscribed * frame.radius;
    a1 = a0 + edge * frame.radius;
    b1 = b0 + edge * frame.radius;
    return gxio_frame_vertex(&frame, a0, b0, 0.0, surface) && gxio_frame_vertex(&frame, a1, b0, 0.0, surface) &&
           gxio_frame_vertex(&frame, a0, b1, 0.0, surface) && gxio_frame_vertex(&frame, a1, b1, 0.0, surface) &&
           gxio_add_triangle(surface, 0, 1, 2, 0) && gxio_add_triangle(surface, 1, 3, 2, 0);
}

/* wave:PX,PY,PZ,NX,NY,NZ,AMPLITUDE,WAVELENGTH[,RESOLUTION]: the points p + s u + t v + A sin(2 pi s / L) n, as strips
   along v, RESOLUTION (16) strips per wavelength, s a multiple of L / RESOLUTION, across the whole body. */
static inline int gxio_generate_wave(const double number[9], const gxio_box *body, gxio_surface *surface) {
    const double amplitude = number[6], wavelength = number[7], step = wavelength / number[8], turn = 6.283185307179586;
    gxio_frame frame;
    double first, last, reach;
    uint32_t i, strips;
    if (!(wavelength > 0.0) || !(number[8] >= 3.0) || !gxio_frame_make(&frame, number, number + 3, body)) return 0;
    reach = 1.1 * frame.radius;
    first = floor((frame.at[0] - reach) / step);
    last = ceil((frame.at[0] + reach) / step);
    if (!(last - first >= 1.0) || last - first > 1e6) return 0;
    strips = (uint32_t)(last - first);
    for (i = 0; i <= strips; i++) {
        const double s = (first + i) * step, h = amplitude * sin(turn * (s / wavelength));
        if (!gxio_frame_vertex(&frame, s, frame.at[1] - reach, h, surface)) return 0;
        if (!gxio_frame_vertex(&frame, s, frame.at[1] + reach, h, surface)) return 0;
    }
    for (i = 0; i < 2 * strips; i += 2) {
        if (!gxio_add_triangle(surface, i, i + 2, i + 3, 0)) return 0;
        if (!gxio_add_triangle(surface, i, i + 3, i + 1, 0)) return 0;
    }
    return 1;
}

/* box:X0,Y0,Z0,X1,Y1,Z1: twelve triangles, counter-clockwise from outside; corner x + 2 y + 4 z. */
static inline int gxio_generate_box(const double number[6], gxio_surface *surface) {
    static const unsigned char face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                             {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    int i;
    for (i = 0; i < 3; i++)
        if (!(number[i] < number[i + 3])) return 0;
    for (i = 0; i < 8; i++)
        if (!gxio_add_vertex(surface, number[i & 1 ? 3 : 0], number[i & 2 ? 4 : 1], number[i & 4 ? 5 : 2])) return 0;
    for (i = 0; i < 6; i++) {
        if (!gxio_add_triangle(surface, face[i][0], face[i][1], face[i][2], 0)) return 0;
        if (!gxio_add_triangle(surface, face[i][0], face[i][2], face[i][3], 0)) return 0;
    }
    return 1;
}

static inline int gxio_surface_generate(const char *spec, const gxio_box *body, gxio_surface *surface,
                                        gxio_error *error) {
    double number[9] = {0, 0, 0, 0, 0, 0, 0, 0, 16};
    const char *list;
    if ((list = gxio_after(spec, "plane:")) != NULL) {
        if (gxio_argument_list(list, number, 6, 6) > 0 && gxio_generate_plane(number, body, surface)) return 1;
        return gxio_fail(error, spec, 0, "is not plane:PX,PY,PZ,NX,NY,NZ with a normal N that is not 0");
    }
    if ((list = gxio_after(spec, "box:")) != NULL) {
        if (gxio_argument_list(list, number, 6, 6) > 0 && gxio_generate_box(number, surface)) return 1;
        return gxio_fail(error, spec, 0, "is not box:X0,Y0,Z0,X1,Y1,Z1 with X0 < X1, Y0 < Y1, Z0 < Z1");
    }
    list = gxio_after(spec, "wave:");
    if (gxio_argument_list(list, number, 8, 9) > 0 && gxio_generate_wave(number, body, surface)) return 1;
    return gxio_fail(error, spec, 0,
                     "is not wave:PX,PY,PZ,NX,NY,NZ,AMPLITUDE,WAVELENGTH[,RESOLUTION] with N not 0, "
                     "WAVELENGTH > 0, RESOLUTION >= 3 and at most 10^6 strips");
}

/* body: what plane and wave sheets must cross. */
static inline int gxio_surface_load(const char *spec, const gxio_box *body, gxio_surface *surface, gxio_error *error) {
    int good;
    memset(surface, 0, sizeof *surface);
    if (gxio_after(spec, "plane:") || gxio_after(spec, "box:") || gxio_after(spec, "wave:"))
        good = gxio_surface_generate(spec, body, surface, error);
    else
        good = gxio_surface_read(spec, surface, error);
    if (!good) gxio_surface_release(surface);
    return good;
}

/* ---------------------------------------------------------------------------------------------- >>blade */

typedef struct gxio_edge {
    size_t first, count; /* of its points; count 0: the blade is lifted */
    size_t line;         /* of the file */
} gxio_edge;

typedef struct gxio_blade {
    double *points;   /* x 3, of one edge after the other; owned */
    gxio_edge *edges; /* edge_count, one for each frame; owned */
    size_t edge_count;
} gxio_blade;

static inline void gxio_blade_release(gxio_blade *blade) {
    free(blade->points);
    free(blade->edges);
    memset(blade, 0, sizeof *blade);
}

/* The points up to the end of the line */
static inline int gxio_edge_points(gxio_reader *reader, gxio_blade *blade, gxio_edge *edge, gxio_error *error) {
    while (gxio_next(reader, GXIO_SAME_LINE)) {
        double *x = blade->points + 3 * (edge->first + edge->count++);
        if (!gxio_parse_number(reader->token, reader->token + reader->token_length, x))
            return gxio_bad_token(reader, "is not a finite number", error);
        if (!gxio_read_number(reader, GXIO_SAME_LINE, "a coordinate", x + 1, error) ||
            !gxio_read_number(reader, GXIO_SAME_LINE, "a coordinate", x + 2, error))
            return 0;
    }
    return 1;
}

/* A line of the file. An edge has as many points as the one before, unless the blade was lifted between them. */
static inline int gxio_blade_edge(gxio_reader *reader, gxio_blade *blade, gxio_error *error) {
    gxio_edge *edge = &blade->edges[blade->edge_count];
    const gxio_edge *before = blade->edge_count ? edge - 1 : NULL;
    edge->first = before ? before->first + before->count : 0;
    edge->count = 0;
    edge->line = reader->line;
    if (!gxio_edge_points(reader, blade, edge, error)) return 0;
    if (edge->count == 1)
        return gxio_fail(error, reader->path, edge->line, "the edge has one point, two are the least");
    if (edge->count && before && before->count && before->count != edge->count)
        return gxio_fail(error, reader->path, edge->line, "the edge has %lu points, and %lu in line %lu",
                         (unsigned long)edge->count, (unsigned long)before->count, (unsigned long)before->line);
    blade->edge_count++;
    return 1;
}

/* Room for all that a file of this text may have: six bytes or more a point, a line an edge */
static inline int gxio_blade_room(const gxio_reader *reader, gxio_blade *blade) {
    size_t lines = 1;
    const char *at;
    for (at = reader->text; at < reader->end; at++) lines += *at == '\n';
    blade->points = (double *)gxio_array((size_t)(reader->end - reader->text) / 6 + 1, 3 * sizeof(double));
    blade->edges = (gxio_edge *)gxio_array(lines, sizeof *blade->edges);
    return blade->points && blade->edges;
}

static inline int gxio_blade_edges(gxio_reader *reader, gxio_blade *blade, gxio_error *error) {
    if (!gxio_blade_room(reader, blade)) return gxio_fail(error, reader->path, 0, "out of memory");
    while (*reader->at) {
        while (gxio_is_blank(*reader->at)) reader->at++;
        if (*reader->at != '#' && !gxio_blade_edge(reader, blade, error)) return 0;
        gxio_next_line(reader);
    }
    while (blade->edge_count && !blade->edges[blade->edge_count - 1].count) blade->edge_count--;
    return blade->edge_count ? 1
                             : gxio_fail(error, reader->path, 0, "has no edge: x y z of each point, a line a frame");
}

/* A line for each frame: x y z of each point of the edge. An empty line lifts the blade; a line that begins with # is a
   comment and no frame. */
static inline int gxio_blade_load(const char *path, gxio_blade *blade, gxio_error *error) {
    gxio_reader reader;
    int good;
    memset(blade, 0, sizeof *blade);
    if (!gxio_reader_open(&reader, path, error)) return 0;
    good = gxio_blade_edges(&reader, blade, error);
    gxio_reader_release(&reader);
    if (!good) gxio_blade_release(blade);
    return good;
}

/* --------------------------------------------------------------------------------------------- >>writer */

/* A file under a temporary name until it is complete. */
typedef struct gxio_writer {
    FILE *stream;
    char path[GXIO_PATH_ROOM], temporary[GXIO_PATH_ROOM + 8];
} gxio_writer;

static inline int gxio_writer_open(gxio_writer *writer, const char *path, gxio_error *error) {
    if (strlen(path) >= sizeof writer->path) return gxio_fail(error, "output", 0, "the path is too long");
    snprintf(writer->path, sizeof writer->path, "%s", path);
    snprintf(writer->temporary, sizeof writer->temporary, "%s.part", path);
    errno = 0;
    writer->stream = fopen(writer->temporary, "wb");
    return writer->stream ? 1 : gxio_fail(error, path, 0, "cannot be written: %s", strerror(errno));
}

/* Gives a file another name, which another file may have until then. At each instant one of the two has it. */
static inline int gxio_replace(const char *from, const char *to) {
#ifdef _WIN32
    return MoveFileExA(from, to, MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
#else
    return rename(from, to) == 0;
#endif
}

/* Closes the file and gives it its name; if `good` is 0 or anything fails, removes it. */
static inline int gxio_writer_close(gxio_writer *writer, int good, gxio_error *error) {
    int complete = good && !ferror(writer->stream);
    errno = 0;
    if (fclose(writer->stream) != 0) complete = 0;
    if (complete && gxio_replace(writer->temporary, writer->path)) return 1;
    gxio_fail(error, writer->path, 0, "cannot be written: %s", errno ? strerror(errno) : "the disk may be full");
    remove(writer->temporary);
    return 0;
}

/* -------------------------------------------------------------------------------------------- >>shells */

/* A triangle surface to be written. Nothing is owned. */
typedef struct gxio_shell {
    const double *vertices; /* vertex_count x 3 */
    size_t vertex_count;
    const uint32_t *triangles; /* triangle_count x 3 */
    size_t triangle_count;
    const uint32_t *component; /* triangle_count, < component_count; NULL: unknown */
    size_t component_count;
} gxio_shell;

static inline void gxio_put_off(FILE *stream, const gxio_shell *s) {
    size_t i;
    fprintf(stream, "OFF\n%lu %lu 0\n", (unsigned long)s->vertex_count, (unsigned long)s->triangle_count);
    for (i = 0; i < 3 * s->vertex_count; i += 3)
        fprintf(stream, "%.17g %.17g %.17g\n", s->vertices[i], s->vertices[i + 1], s->vertices[i + 2]);
    for (i = 0; i < 3 * s->triangle_count; i += 3)
        fprintf(stream, "3 %lu %lu %lu\n", (unsigned long)s->triangles[i], (unsigned long)s->triangles[i + 1],
                (unsigned long)s->triangles[i + 2]);
}

static inline void gxio_put_obj_face(FILE *stream, const uint32_t *corners) {
    fprintf(stream, "f %lu %lu %lu\n", corners[0] + 1ul, corners[1] + 1ul, corners[2] + 1ul);
}

/* An object per component, if components are known. Returns 0 if there is no memory for their order. */
static inline int gxio_put_obj(FILE *stream, const gxio_shell *s) {
    size_t i, c, *start = NULL, *order = NULL;
    for (i = 0; i < 3 * s->vertex_count; i += 3)
        fprintf(stream, "v %.17g %.17g %.17g\n", s->vertices[i], s->vertices[i + 1], s->vertices[i + 2]);
    if (!s->component) {
        for (i = 0; i < s->triangle_count; i++) gxio_put_obj_face(stream, s->triangles + 3 * i);
        return 1;
    }
    start = (size_t *)calloc(s->component_count + 2, sizeof *start);
    order = (size_t *)gxio_array(s->triangle_count + 1, sizeof *order);
    if (start && order) {
        for (i = 0; i < s->triangle_count; i++) start[s->component[i] + 2]++;
        for (c = 2; c < s->component_count + 2; c++) start[c] += start[c - 1];
        for (i = 0; i < s->triangle_count; i++) order[start[s->component[i] + 1]++] = i;
        for (c = 0; c < s->component_count; c++) {
            fprintf(stream, "o component_%lu\n", (unsigned long)c);
            for (i = start[c]; i < start[c + 1]; i++) gxio_put_obj_face(stream, s->triangles + 3 * order[i]);
        }
    }
    c = start && order;
    free(start);
    free(order);
    return (int)c;
}

static inline void gxio_put_word(unsigned char *bytes, uint32_t word) {
    int i;
    for (i = 0; i < 4; i++) bytes[i] = (unsigned char)(word >> 8 * i);
}

/* Binary STL: single precision, least significant byte first */
static inline void gxio_put_stl(FILE *stream, const gxio_shell *s) {
    unsigned char bytes[84];
    size_t t;
    int i, k;
    memset(bytes, 0, sizeof bytes);
    gxio_put_word(bytes + 80, (uint32_t)s->triangle_count);
    fwrite(bytes, 1, 84, stream);
    for (t = 0; t < s->triangle_count; t++) {
        const double *x[3];
        double u[3], v[3], n[3], length;
        float number[12];
        for (i = 0; i < 3; i++) x[i] = s->vertices + 3 * (size_t)s->triangles[3 * t + (size_t)i];
        for (k = 0; k < 3; k++) {
            u[k] = x[1][k] - x[0][k];
            v[k] = x[2][k] - x[0][k];
        }
        for (k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (k = 0; k < 3; k++) {
            number[k] = (float)(length > 0 ? n[k] / length : 0);
            for (i = 0; i < 3; i++) number[3 + 3 * i + k] = (float)x[i][k];
        }
        memset(bytes, 0, 50);
        for (i = 0; i < 12; i++) {
            uint32_t word;
            memcpy(&word, &number[i], 4);
            gxio_put_word(bytes + 4 * i, word);
        }
        fwrite(bytes, 1, 50, stream);
    }
}

static inline int gxio_is_surface_name(const char *path) {
    return gxio_ends_with(path, ".off") || gxio_ends_with(path, ".obj") || gxio_ends_with(path, ".stl");
}

/* Writes FILE.off, FILE.obj or FILE.stl. */
static inline int gxio_write_surface(const char *path, const gxio_shell *s, gxio_error *error) {
    gxio_writer writer;
    int good = 1;
    if (!gxio_writer_open(&writer, path, error)) return 0;
    if (gxio_ends_with(path, ".obj"))
        good = gxio_put_obj(writer.stream, s);
    else if (gxio_ends_with(path, ".stl"))
        gxio_put_stl(writer.stream, s);
    else
        gxio_put_off(writer.stream, s);
    if (gxio_writer_close(&writer, good, error)) return 1;
    return good ? 0 : gxio_fail(error, path, 0, "out of memory");
}

/* --------------------------------------------------------------------------------------------- >>frames */

/* Triangles of one instant: positions of a skin and what is known per triangle. Nothing is owned. */
typedef struct gxio_triangles {
    const double *positions; /* vertex_count x 3, m */
    const float *normals;    /* vertex_count x 3 */
    const float *texture;    /* vertex_count x 2, texture coordinates */
    size_t vertex_count;
    const uint32_t *triangles; /* triangle_count x 3 */
    const uint32_t *fragment;  /* triangle_count, < fragment_count */
    const uint32_t *surface;   /* triangle_count, 0: outer surface; else the number of the cut's surface, from 1 */
    const uint32_t *material;  /* triangle_count */
    size_t triangle_count, fragment_count;
} gxio_triangles;

/* Base64 of a stream of bytes, three at a time. */
typedef struct gxio_base64 {
    FILE *stream;
    unsigned char pending[3];
    size_t pending_count, used;
    char text[4096];
} gxio_base64;

static inline void gxio_base64_flush(gxio_base64 *out) {
    fwrite(out->text, 1, out->used, out->stream);
    out->used = 0;
}

static inline void gxio_base64_group(gxio_base64 *out, const unsigned char b[3]) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text;
    if (out->used == sizeof out->text) gxio_base64_flush(out);
    text = out->text + out->used;
    text[0] = digit[b[0] >> 2];
    text[1] = digit[(b[0] & 3) << 4 | b[1] >> 4];
    text[2] = digit[(b[1] & 15) << 2 | b[2] >> 6];
    text[3] = digit[b[2] & 63];
    out->used += 4;
}

static inline void gxio_base64_bytes(gxio_base64 *out, const void *bytes, size_t count) {
    const unsigned char *byte = (const unsigned char *)bytes;
    size_t i;
    for (i = 0; i < count; i++) {
        out->pending[out->pending_count++] = byte[i];
        if (out->pending_count == 3) {
            gxio_base64_group(out, out->pending);
            out->pending_count = 0;
        }
    }
}

/* Pads the last group with '=' and empties the buffers. */
static inline void gxio_base64_end(gxio_base64 *out) {
    const size_t padding = out->pending_count ? 3 - out->pending_count : 0;
    if (padding) {
        memset(out->pending + out->pending_count, 0, padding);
        gxio_base64_group(out, out->pending);
        memset(out->text + out->used - padding, '=', padding);
    }
    gxio_base64_flush(out);
    out->pending_count = 0;
}

/* One appended array of a .vtu file: its size in bytes (64 bits), then its values, as one base64 text. */
typedef struct gxio_block {
    const void *bytes;
    size_t size;
} gxio_block;

static inline size_t gxio_block_length(const gxio_block *block) { return (sizeof(uint64_t) + block->size + 2) / 3 * 4; }

static inline void gxio_block_write(const gxio_block *block, FILE *stream) {
    const uint64_t size = block->size;
    gxio_base64 out;
    out.stream = stream;
    out.pending_count = out.used = 0;
    gxio_base64_bytes(&out, &size, sizeof size);
    gxio_base64_bytes(&out, block->bytes, block->size);
    gxio_base64_end(&out);
}

static inline const char *gxio_byte_order(void) {
    const uint16_t probe = 1;
    unsigned char low;
    memcpy(&low, &probe, 1);
    return low ? "LittleEndian" : "BigEndian";
}

/* One array of a .vtu file: what stands before it, up to its name, and its bytes */
typedef struct gxio_array_block {
    const char *head;
    gxio_block block;
} gxio_array_block;

enum { GXIO_VTU_ARRAYS = 9 };

static inline void gxio_vtu_write(FILE *stream, const gxio_triangles *t,
                                  const gxio_array_block array[GXIO_VTU_ARRAYS]) {
    unsigned long offset = 0;
    int i;
    fprintf(stream,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" "
            "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"%lu\" NumberOfCells=\"%lu\">\n",
            gxio_byte_order(), (unsigned long)t->vertex_count, (unsigned long)t->triangle_count);
    for (i = 0; i < GXIO_VTU_ARRAYS; i++) {
        fprintf(stream, "%s format=\"appended\" offset=\"%lu\"/>\n", array[i].head, offset);
        offset += (unsigned long)gxio_block_length(&array[i].block);
    }
    fputs("</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"base64\">\n_", stream);
    for (i = 0; i < GXIO_VTU_ARRAYS; i++) gxio_block_write(&array[i].block, stream);
    fputs("\n</AppendedData>\n</VTKFile>\n", stream);
}

static inline gxio_array_block gxio_vtu_array(const char *head, const void *bytes, size_t size) {
    gxio_array_block array;
    array.head = head;
    array.block.bytes = bytes;
    array.block.size = size;
    return array;
}

/* VTK's unstructured grid of triangles: normals and texture coordinates by vertex; fragment, surface and material by
 * triangle. */
static inline int gxio_write_vtu(const char *path, const gxio_triangles *t, gxio_error *error) {
    const size_t n = t->triangle_count, v = t->vertex_count, word = sizeof(uint32_t);
    uint32_t *ends = (uint32_t *)gxio_array(n, word);
    unsigned char *types = (unsigned char *)gxio_array(n, 1);
    gxio_writer writer;
    gxio_array_block array[GXIO_VTU_ARRAYS];
    size_t i;
    int good = ends && types ? gxio_writer_open(&writer, path, error) : gxio_fail(error, path, 0, "out of memory");
    if (good) {
        for (i = 0; i < n; i++) ends[i] = (uint32_t)(3 * (i + 1));
        memset(types, 5, n); /* VTK_TRIANGLE */
        array[0] = gxio_vtu_array("<PointData Normals=\"normal\" TCoords=\"texture\">\n<DataArray type=\"Float32\" "
                                  "Name=\"normal\" NumberOfComponents=\"3\"",
                                  t->normals, v * 3 * sizeof(float));
        array[1] = gxio_vtu_array("<DataArray type=\"Float32\" Name=\"texture\" NumberOfComponents=\"2\"", t->texture,
                                  v * 2 * sizeof(float));
        array[2] = gxio_vtu_array(
            "</PointData>\n<Points>\n<DataArray type=\"Float64\" Name=\"position\" NumberOfComponents=\"3\"",
            t->positions, v * 3 * sizeof(double));
        array[3] = gxio_vtu_array("</Points>\n<Cells>\n<DataArray type=\"UInt32\" Name=\"connectivity\"", t->triangles,
                                  n * 3 * word);
        array[4] = gxio_vtu_array("<DataArray type=\"UInt32\" Name=\"offsets\"", ends, n * word);
        array[5] = gxio_vtu_array("<DataArray type=\"UInt8\" Name=\"types\"", types, n);
        array[6] =
            gxio_vtu_array("</Cells>\n<CellData Scalars=\"fragment\">\n<DataArray type=\"UInt32\" Name=\"fragment\"",
                           t->fragment, n * word);
        array[7] = gxio_vtu_array("<DataArray type=\"UInt32\" Name=\"surface\"", t->surface, n * word);
        array[8] = gxio_vtu_array("<DataArray type=\"UInt32\" Name=\"material\"", t->material, n * word);
        gxio_vtu_write(writer.stream, t, array);
        good = gxio_writer_close(&writer, 1, error);
    }
    free(ends);
    free(types);
    return good;
}

/* Triangle numbers sorted by fragment; order: triangle_count, start: fragment_count + 1. */
static inline void gxio_sort_by_fragment(const gxio_triangles *t, size_t *order, size_t *start) {
    size_t i, f;
    for (f = 0; f <= t->fragment_count; f++) start[f] = 0;
    for (i = 0; i < t->triangle_count; i++) start[t->fragment[i]]++;
    for (f = 0, i = 0; f <= t->fragment_count; f++) start[f] = i += start[f];
    for (i = t->triangle_count; i-- > 0;) order[--start[t->fragment[i]]] = i;
}

static inline void gxio_obj_write(FILE *stream, const gxio_triangles *t, const size_t *order, const size_t *start) {
    size_t i, f, k;
    for (i = 0; i < t->vertex_count; i++) {
        const double *x = t->positions + 3 * i;
        const float *n = t->normals + 3 * i, *uv = t->texture + 2 * i;
        fprintf(stream, "v %.9g %.9g %.9g\nvt %.9g %.9g\nvn %.5g %.5g %.5g\n", x[0], x[1], x[2], (double)uv[0],
                (double)uv[1], (double)n[0], (double)n[1], (double)n[2]);
    }
    for (f = 0; f < t->fragment_count; f++) {
        fprintf(stream, "g fragment_%lu\n", (unsigned long)f);
        for (i = start[f]; i < start[f + 1]; i++) {
            const uint32_t *corner = t->triangles + 3 * order[i];
            fputc('f', stream);
            for (k = 0; k < 3; k++) fprintf(stream, " %lu/%lu/%lu", corner[k] + 1ul, corner[k] + 1ul, corner[k] + 1ul);
            fputc('\n', stream);
        }
    }
}

/* Wavefront, a group per fragment. */
static inline int gxio_write_obj(const char *path, const gxio_triangles *t, gxio_error *error) {
    size_t *order = (size_t *)gxio_array(t->triangle_count, sizeof(size_t));
    size_t *start = (size_t *)gxio_array(t->fragment_count + 1, sizeof(size_t));
    gxio_writer writer;
    int good = order && start ? gxio_writer_open(&writer, path, error) : gxio_fail(error, path, 0, "out of memory");
    if (good) {
        gxio_sort_by_fragment(t, order, start);
        gxio_obj_write(writer.stream, t, order, start);
        good = gxio_writer_close(&writer, 1, error);
    }
    free(order);
    free(start);
    return good;
}

static inline void gxio_frame_name(char *name, size_t room, uint32_t frame, const char *ending) {
    snprintf(name, room, "frame_%04lu.%s", (unsigned long)frame, ending);
}

/* The .pvd collection of frames 0..frame_count - 1, named by gxio_frame_name, frame i at the time (i + 1) dt. */
static inline int gxio_write_pvd(const char *path, uint32_t frame_count, double dt, gxio_error *error) {
    gxio_writer writer;
    uint32_t i;
    char name[32];
    if (!gxio_writer_open(&writer, path, error)) return 0;
    fprintf(writer.stream,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"%s\">\n<Collection>\n",
            gxio_byte_order());
    for (i = 0; i < frame_count; i++) {
        gxio_frame_name(name, sizeof name, i, "vtu");
        fprintf(writer.stream, "<DataSet timestep=\"%.9g\" part=\"0\" file=\"%s\"/>\n", (i + 1.0) * dt, name);
    }
    fputs("</Collection>\n</VTKFile>\n", writer.stream);
    return gxio_writer_close(&writer, 1, error);
}

/* ----------------------------------------------------------------------------------------------- >>page */

/* A page in the making: player.html with the frames so far. player.js says how frames are written. */
typedef struct gxio_page {
    gxio_writer writer;
    gxio_base64 out;
} gxio_page;

static inline void gxio_page_byte(gxio_page *page, uint32_t value) {
    const unsigned char byte = (unsigned char)(value & 255);
    gxio_base64_bytes(&page->out, &byte, 1);
}

/* The low `bytes` bytes of a value, lowest first */
static inline void gxio_page_value(gxio_page *page, uint32_t value, int bytes) {
    for (; bytes-- > 0; value >>= 8) gxio_page_byte(page, value);
}

static inline void gxio_page_float(gxio_page *page, double value) {
    const float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    gxio_page_value(page, bits, 4);
}

/* Begins a line of base64; gxio_page_end_line ends it. */
static inline void gxio_page_begin_line(gxio_page *page, const char *name) {
    fprintf(page->writer.stream, "%s ", name);
    page->out.stream = page->writer.stream;
    page->out.pending_count = page->out.used = 0;
}

static inline void gxio_page_end_line(gxio_page *page) {
    gxio_base64_end(&page->out);
    fputc('\n', page->writer.stream);
}

/* A JSON string that is safe inside a script element */
static inline void gxio_page_text(gxio_page *page, const char *text) {
    fputc('"', page->writer.stream);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c < ' ' || c == '"' || c == '\\' || c == '<')
            fprintf(page->writer.stream, "\\u%04x", (unsigned)c);
        else
            fputc(c, page->writer.stream);
    }
    fputc('"', page->writer.stream);
}

/* Opens a page without frames. */
static inline int gxio_page_open(gxio_page *page, const char *path, const char *title, const double up[3],
                                 gxio_error *error) {
    const char *const *line;
    if (!gxio_writer_open(&page->writer, path, error)) return 0;
    for (line = gxio_player_top; *line; line++) fputs(*line, page->writer.stream);
    fprintf(page->writer.stream, "gxfem-frames 1\ntitle ");
    gxio_page_text(page, title);
    fprintf(page->writer.stream, "\nup %.9g %.9g %.9g\n", up[0], up[1], up[2]);
    return 1;
}

/* The triangles of the frames that follow. fragment_id: fragment_count numbers, each the same fragment's in all meshes
 */
static inline void gxio_page_mesh(gxio_page *page, const gxio_triangles *t, const uint32_t *fragment_id) {
    size_t i;
    gxio_page_begin_line(page, "mesh");
    gxio_page_value(page, (uint32_t)t->vertex_count, 4);
    gxio_page_value(page, (uint32_t)t->triangle_count, 4);
    for (i = 0; i < 3 * t->triangle_count; i++) gxio_page_value(page, t->triangles[i], 4);
    for (i = 0; i < t->triangle_count; i++) gxio_page_value(page, fragment_id[t->fragment[i]], 4);
    for (i = 0; i < t->triangle_count; i++) gxio_page_value(page, t->surface[i], 4);
    gxio_page_end_line(page);
}

/* A normal as a point of the octahedron |x| + |y| + |z| = 127, seen from above; its lower half is folded outwards. */
static inline void gxio_page_normal(gxio_page *page, const float n[3]) {
    const double sum = fabs((double)n[0]) + fabs((double)n[1]) + fabs((double)n[2]);
    double x = sum > 0.0 ? (double)n[0] / sum : 0.0, y = sum > 0.0 ? (double)n[1] / sum : 0.0;
    if (n[2] < 0.0f) {
        const double folded = (1.0 - fabs(y)) * (x < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(x)) * (y < 0.0 ? -1.0 : 1.0);
        x = folded;
    }
    gxio_page_byte(page, (uint32_t)(int32_t)floor(127.0 * x + 0.5));
    gxio_page_byte(page, (uint32_t)(int32_t)floor(127.0 * y + 0.5));
}

/* Where the triangles of the last gxio_page_mesh are at a time, s. Positions are rounded to 1/65535 of the frame's box.
 */
static inline void gxio_page_frame(gxio_page *page, const gxio_triangles *t, double time) {
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, scale[3];
    size_t i;
    if (t->vertex_count) gxio_bounds(t->positions, t->vertex_count, low, high);
    gxio_page_begin_line(page, "frame");
    gxio_page_float(page, time);
    for (i = 0; i < 3; i++) gxio_page_float(page, low[i]);
    for (i = 0; i < 3; i++) gxio_page_float(page, high[i]);
    for (i = 0; i < 3; i++) scale[i] = high[i] > low[i] ? 65535.0 / (high[i] - low[i]) : 0.0;
    for (i = 0; i < 3 * t->vertex_count; i++)
        gxio_page_value(page, (uint32_t)((t->positions[i] - low[i % 3]) * scale[i % 3] + 0.5), 2);
    for (i = 0; i < t->vertex_count; i++) gxio_page_normal(page, t->normals + 3 * i);
    gxio_page_end_line(page);
}

/* Completes the page, or removes it if `good` is 0 or anything fails. */
static inline int gxio_page_close(gxio_page *page, int good, gxio_error *error) {
    const char *const *line;
    for (line = gxio_player_end; *line; line++) fputs(*line, page->writer.stream);
    return gxio_writer_close(&page->writer, good, error);
}

/* ---------------------------------------------------------------------------------------------- >>clock */

/* Seconds from some fixed instant; user is ignored (the signature is gx_body_desc's). */
static inline double gxio_seconds(void *user) {
    (void)user;
#if defined(_WIN32)
    {
        LARGE_INTEGER now, frequency;
        QueryPerformanceFrequency(&frequency);
        QueryPerformanceCounter(&now);
        return (double)now.QuadPart / (double)frequency.QuadPart;
    }
#elif defined(CLOCK_MONOTONIC)
    {
        struct timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
    }
#elif defined(TIME_UTC)
    {
        struct timespec now;
        timespec_get(&now, TIME_UTC);
        return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
    }
#else
    return (double)clock() / (double)CLOCKS_PER_SEC;
#endif
}

/* Makes a directory (not its parents) unless it is there. */
static inline int gxio_make_directory(const char *path, gxio_error *error) {
    int failed;
    errno = 0;
#ifdef _WIN32
    failed = _mkdir(path);
#else
    failed = mkdir(path, 0777);
#endif
    return !failed || errno == EEXIST ? 1 : gxio_fail(error, path, 0, "cannot be made: %s", strerror(errno));
}

#endif /* GXIO_H */
