/* gxjson.h: reads a JSON file (RFC 8259) into an array of values.

   A value's children follow it: the items of an array, or key, value, key, value ... of an object. `next` says where
   the first value behind it and its children is. So the children of value i are i + 1, values[i + 1].next ... up to
   values[i].next. Value 0 is the whole; no other value has it as a child, so 0 also says that there is none. Include
   gxio.h before. */
#ifndef GXJSON_H
#define GXJSON_H

enum { GXJSON_NULL = 0, GXJSON_BOOLEAN, GXJSON_NUMBER, GXJSON_STRING, GXJSON_ARRAY, GXJSON_OBJECT };
enum { GXJSON_DEPTH = 64 }; /* deeper files are refused */

typedef struct gxjson_value {
    uint32_t kind;
    size_t next;
    const char *text; /* its first character in the file; a string's quotation mark */
    size_t length;    /* up to its last character, a string's quotation marks included; of a container: 1 */
    size_t line;
} gxjson_value;

typedef struct gxjson {
    gxio_reader reader;
    gxjson_value *values;
    size_t count, room;
} gxjson;

static inline void gxjson_release(gxjson *json) {
    gxio_reader_release(&json->reader);
    free(json->values);
    memset(json, 0, sizeof *json);
}

static inline int gxjson_fail(gxjson *json, const char *cause, gxio_error *error) {
    return gxio_fail(error, json->reader.path, json->reader.line, "%s", cause);
}

/* The next character that is not blank; 0 at the end */
static inline char gxjson_peek(gxjson *json) {
    gxio_reader *r = &json->reader;
    for (; *r->at == ' ' || *r->at == '\t' || *r->at == '\r' || *r->at == '\n'; r->at++) r->line += *r->at == '\n';
    return *r->at;
}

static inline int gxjson_take(gxjson *json, char c) {
    if (gxjson_peek(json) != c) return 0;
    json->reader.at++;
    return 1;
}

/* Starts a value at the reader's place. */
static inline gxjson_value *gxjson_add(gxjson *json, uint32_t kind) {
    gxjson_value *value;
    if (json->count == json->room) {
        const size_t room = json->room ? 2 * json->room : 256;
        gxjson_value *grown = (gxjson_value *)realloc(json->values, room * sizeof *grown);
        if (!grown) return NULL;
        json->values = grown;
        json->room = room;
    }
    value = &json->values[json->count++];
    value->kind = kind;
    value->text = json->reader.at;
    value->line = json->reader.line;
    value->length = 1;
    value->next = json->count;
    return value;
}

static inline int gxjson_is_hex(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

static inline int gxjson_read_string(gxjson *json, gxio_error *error) {
    gxio_reader *r = &json->reader;
    gxjson_value *value = gxjson_add(json, GXJSON_STRING);
    if (!value) return gxjson_fail(json, "out of memory", error);
    for (r->at++; *r->at != '"'; r->at++) {
        if ((unsigned char)*r->at < 0x20) return gxjson_fail(json, "a string does not end on its line", error);
        if (*r->at != '\\') continue;
        r->at++;
        if (*r->at == 'u') {
            int i;
            for (i = 1; i <= 4; i++)
                if (!gxjson_is_hex(r->at[i])) return gxjson_fail(json, "\\u needs four hexadecimal digits", error);
            r->at += 4;
        } else if (*r->at == 0 || !strchr("\"\\/bfnrt", *r->at))
            return gxjson_fail(json, "an unknown escape in a string", error);
    }
    r->at++;
    value->length = (size_t)(r->at - value->text);
    return 1;
}

/* A number, true, false or null */
static inline int gxjson_read_word(gxjson *json, gxio_error *error) {
    static const char *const words[] = {"null", "true", "false"};
    static const uint32_t kinds[] = {GXJSON_NULL, GXJSON_BOOLEAN, GXJSON_BOOLEAN};
    gxio_reader *r = &json->reader;
    const size_t length = strspn(r->at, "+-.0123456789abcdefghijklmnopqrstuvwxyzE");
    double number;
    uint32_t kind = GXJSON_NUMBER;
    gxjson_value *value;
    int i, known = length > 0 && *r->at != '+' && gxio_parse_number(r->at, r->at + length, &number);
    for (i = 0; i < 3; i++)
        if (length == strlen(words[i]) && strncmp(r->at, words[i], length) == 0) {
            known = 1;
            kind = kinds[i];
        }
    if (!known) return gxjson_fail(json, "neither a value nor a finite number", error);
    value = gxjson_add(json, kind);
    if (!value) return gxjson_fail(json, "out of memory", error);
    value->length = length;
    r->at += length;
    return 1;
}

static inline int gxjson_read_value(gxjson *json, int depth, gxio_error *error) {
    const char first = gxjson_peek(json);
    const char last = first == '{' ? '}' : ']';
    const size_t index = json->count;
    if (first == '"') return gxjson_read_string(json, error);
    if (first != '{' && first != '[') return gxjson_read_word(json, error);
    if (depth == GXJSON_DEPTH) return gxjson_fail(json, "nested too deeply", error);
    if (!gxjson_add(json, first == '{' ? GXJSON_OBJECT : GXJSON_ARRAY))
        return gxjson_fail(json, "out of memory", error);
    json->reader.at++;
    if (!gxjson_take(json, last)) {
        do {
            if (first == '{') {
                if (gxjson_peek(json) != '"') return gxjson_fail(json, "an object's key should stand here", error);
                if (!gxjson_read_string(json, error)) return 0;
                if (!gxjson_take(json, ':')) return gxjson_fail(json, "a key needs a colon behind it", error);
            }
            if (!gxjson_read_value(json, depth + 1, error)) return 0;
        } while (gxjson_take(json, ','));
        if (!gxjson_take(json, last))
            return gxjson_fail(json, first == '{' ? "neither , nor } behind a value" : "neither , nor ] behind a value",
                               error);
    }
    json->values[index].next = json->count;
    return 1;
}

/* Reads a file. On failure nothing needs to be released. */
static inline int gxjson_read(gxjson *json, const char *path, gxio_error *error) {
    memset(json, 0, sizeof *json);
    if (!gxio_reader_open(&json->reader, path, error)) return 0;
    if (gxjson_read_value(json, 0, error) &&
        (gxjson_peek(json) == 0 || gxjson_fail(json, "something stands behind the value", error)))
        return 1;
    gxjson_release(json);
    return 0;
}

static inline int gxjson_is(const gxjson *json, size_t i, uint32_t kind) {
    return i > 0 && json->values[i].kind == kind;
}

/* Is value i this string? None of the strings that a program asks for has an escape. */
static inline int gxjson_equals(const gxjson *json, size_t i, const char *text) {
    const gxjson_value *value = &json->values[i];
    return value->kind == GXJSON_STRING && value->length == strlen(text) + 2 &&
           strncmp(value->text + 1, text, value->length - 2) == 0;
}

/* The value of a key in object i (0 may be asked, too: the whole); 0 if there is none */
static inline size_t gxjson_find(const gxjson *json, size_t i, const char *key) {
    size_t at;
    if (json->values[i].kind != GXJSON_OBJECT) return 0;
    for (at = i + 1; at < json->values[i].next; at = json->values[at + 1].next)
        if (gxjson_equals(json, at, key)) return at + 1;
    return 0;
}

static inline uint32_t gxjson_hex(const char *text) {
    uint32_t sum = 0;
    int i;
    for (i = 0; i < 4; i++) {
        const char c = text[i];
        sum = 16 * sum + (uint32_t)(c <= '9' ? c - '0' : (c | 32) - 'a' + 10);
    }
    return sum;
}

static inline char *gxjson_put_utf8(char *out, uint32_t code) {
    if (code < 0x80) {
        *out++ = (char)code;
        return out;
    }
    if (code < 0x800)
        *out++ = (char)(0xc0 | code >> 6);
    else {
        if (code < 0x10000)
            *out++ = (char)(0xe0 | code >> 12);
        else {
            *out++ = (char)(0xf0 | code >> 18);
            *out++ = (char)(0x80 | (code >> 12 & 63));
        }
        *out++ = (char)(0x80 | (code >> 6 & 63));
    }
    *out++ = (char)(0x80 | (code & 63));
    return out;
}

/* A string in UTF-8, to be freed by the caller; NULL if there is no memory. Half a pair of surrogates becomes U+FFFD.
 */
static inline char *gxjson_text(const gxjson *json, size_t i) {
    static const char escapes[] = "bfnrt", codes[] = "\b\f\n\r\t";
    const char *at = json->values[i].text + 1, *end = json->values[i].text + json->values[i].length - 1;
    char *text = (char *)malloc(json->values[i].length), *out = text;
    if (!text) return NULL;
    while (at < end) {
        uint32_t code;
        const char *escape;
        if (*at != '\\') {
            *out++ = *at++;
            continue;
        }
        escape = strchr(escapes, at[1]);
        at += 2;
        if (at[-1] != 'u') {
            *out++ = escape ? codes[escape - escapes] : at[-1];
            continue;
        }
        code = gxjson_hex(at);
        at += 4;
        if (code >= 0xd800 && code < 0xdc00 && end - at >= 6 && at[0] == '\\' && at[1] == 'u') {
            const uint32_t low = gxjson_hex(at + 2);
            if (low >= 0xdc00 && low < 0xe000) {
                code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
                at += 6;
            }
        }
        out = gxjson_put_utf8(out, code >= 0xd800 && code < 0xe000 ? 0xfffd : code);
    }
    *out = 0;
    return text;
}

/* An integer of 0 .. below - 1? */
static inline int gxjson_index(const gxjson *json, size_t i, size_t below, size_t *index) {
    const gxjson_value *value = &json->values[i];
    int64_t number = 0;
    if (!gxjson_is(json, i, GXJSON_NUMBER) || !gxio_parse_integer(value->text, value->text + value->length, &number) ||
        number < 0 || (uint64_t)number >= below)
        return 0;
    *index = (size_t)number;
    return 1;
}

#endif /* GXJSON_H */
