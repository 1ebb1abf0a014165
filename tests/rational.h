/* rational.h - exact arithmetic for tests: slow, simple, obviously right.

   A `big` is sign * integer * 2^(32 exponent): every double is one, and sums, differences and products of doubles are
   exact. A `rat` is a fraction of two bigs and is closed under division too; it is never reduced.

       rat_mark mark = rat_arena_mark();
       rat x = rat_div(rat_from_double(1.0), rat_from_double(3.0));
       int s = rat_compare(x, rat_from_double(0.333));               // 1
       rat_arena_release(mark);                                      // frees all that was made since the mark

   Numbers are values (copy them freely); their limbs are never changed once made and live in one growing arena until it
   is released. Out of memory and division by zero end the program: this is for tests. Not for several threads.

   big_det3, big_orient2d, big_orient3d: the determinants that geometry needs. */
#ifndef GXFEM_TESTS_RATIONAL_H
#define GXFEM_TESTS_RATIONAL_H

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the arena: blocks of limbs, filled in order ---- */
enum { RAT_BLOCK_LIMBS = 1 << 18, RAT_BLOCKS = 4096 };

typedef struct rat_mark {
    size_t block; /* the block being filled */
    size_t used;  /* limbs taken from it */
} rat_mark;

static uint32_t *rat_blocks[RAT_BLOCKS];
static rat_mark rat_arena;

static inline void rat_stop(const char *why) {
    fprintf(stderr, "rational.h: %s\n", why);
    abort();
}

static inline rat_mark rat_arena_mark(void) { return rat_arena; }
static inline void rat_arena_release(rat_mark mark) { rat_arena = mark; }

/* Releases the blocks as well; every number made so far is gone. */
static inline void rat_arena_free(void) {
    size_t i;
    for (i = 0; i < RAT_BLOCKS; i++) {
        free(rat_blocks[i]);
        rat_blocks[i] = NULL;
    }
    rat_arena.block = 0;
    rat_arena.used = 0;
}

static inline uint32_t *rat_limbs(size_t count) {
    uint32_t *limbs;
    if (count > RAT_BLOCK_LIMBS) rat_stop("number too long");
    if (rat_arena.used + count > RAT_BLOCK_LIMBS) {
        if (++rat_arena.block == RAT_BLOCKS) rat_stop("arena full");
        rat_arena.used = 0;
    }
    if (rat_blocks[rat_arena.block] == NULL) {
        rat_blocks[rat_arena.block] = (uint32_t *)malloc(RAT_BLOCK_LIMBS * sizeof(uint32_t));
        if (rat_blocks[rat_arena.block] == NULL) rat_stop("out of memory");
    }
    limbs = rat_blocks[rat_arena.block] + rat_arena.used;
    rat_arena.used += count;
    return limbs;
}

/* ---- bigs: dyadic numbers ---- */
typedef struct big {
    const uint32_t *limb; /* count limbs, least significant first; neither the first nor the last is 0 */
    int32_t count;        /* 0: the number is zero */
    int32_t exponent;     /* of the first limb, in limbs */
    int32_t sign;         /* -1, 0, 1 */
} big;

static inline big big_zero(void) {
    big zero = {NULL, 0, 0, 0};
    return zero;
}

/* Strips zero limbs at both ends, which makes the representation unique. */
static inline big big_normalised(const uint32_t *limb, int32_t count, int32_t exponent, int32_t sign) {
    big x;
    while (count > 0 && limb[count - 1] == 0) count--;
    while (count > 0 && limb[0] == 0) {
        limb++;
        exponent++;
        count--;
    }
    if (count == 0) return big_zero();
    x.limb = limb;
    x.count = count;
    x.exponent = exponent;
    x.sign = sign;
    return x;
}

/* Exact, denormals included. x must be finite. */
static inline big big_from_double(double x) {
    uint64_t bits, mantissa;
    uint32_t *limb;
    int32_t power, exponent, shift;
    memcpy(&bits, &x, sizeof bits);
    power = (int32_t)((bits >> 52) & 0x7ff);
    mantissa = bits & ((UINT64_C(1) << 52) - 1);
    if (power == 0x7ff) rat_stop("not a finite double");
    if (power == 0)
        power = 1;
    else
        mantissa |= UINT64_C(1) << 52;
    power += 32 * 64 - 1075; /* now x = mantissa 2^(power - 32 64), and power > 0 */
    exponent = power / 32;
    shift = power % 32;
    limb = rat_limbs(3);
    limb[0] = (uint32_t)(mantissa << shift);
    limb[1] = (uint32_t)((mantissa >> (32 - shift)));
    limb[2] = shift == 0 ? 0 : (uint32_t)(mantissa >> (64 - shift));
    return big_normalised(limb, 3, exponent - 64, bits >> 63 ? -1 : 1);
}

static inline big big_from_int(int32_t x) { return big_from_double((double)x); }

/* The limb that counts 2^(32 position): 0 outside the number. */
static inline uint32_t big_limb(big x, int32_t position) {
    int32_t i = position - x.exponent;
    return i >= 0 && i < x.count ? x.limb[i] : 0;
}

static inline int32_t big_top(big x) { return x.exponent + x.count; }
static inline int32_t rat_min(int32_t a, int32_t b) { return a < b ? a : b; }
static inline int32_t rat_max(int32_t a, int32_t b) { return a > b ? a : b; }

static inline big big_neg(big x) {
    x.sign = -x.sign;
    return x;
}
static inline big big_abs(big x) {
    x.sign = x.sign != 0;
    return x;
}
static inline int big_sign(big x) { return x.sign; }

/* -1, 0, 1: |a| against |b| */
static inline int big_compare_abs(big a, big b) {
    int32_t i, low;
    if (a.sign == 0 || b.sign == 0) return (a.sign != 0) - (b.sign != 0);
    if (big_top(a) != big_top(b)) return big_top(a) > big_top(b) ? 1 : -1;
    low = rat_min(a.exponent, b.exponent);
    for (i = big_top(a) - 1; i >= low; i--) {
        uint32_t p = big_limb(a, i), q = big_limb(b, i);
        if (p != q) return p > q ? 1 : -1;
    }
    return 0;
}

/* |a| + |b|, or |a| - |b| where |a| >= |b|, with the sign given. Neither is 0. */
static inline big big_sum_abs(big a, big b, int subtract, int32_t sign) {
    int32_t low = rat_min(a.exponent, b.exponent), high = rat_max(big_top(a), big_top(b)) + 1, i;
    uint32_t *limb = rat_limbs((size_t)(high - low));
    int64_t carry = 0;
    for (i = low; i < high; i++) {
        int64_t p = big_limb(a, i), q = big_limb(b, i);
        carry += subtract ? p - q : p + q;
        limb[i - low] = (uint32_t)(carry & 0xffffffff);
        carry = carry < 0 ? -1 : carry >> 32;
    }
    return big_normalised(limb, high - low, low, sign);
}

static inline big big_add(big a, big b) {
    if (a.sign == 0) return b;
    if (b.sign == 0) return a;
    if (a.sign == b.sign) return big_sum_abs(a, b, 0, a.sign);
    if (big_compare_abs(a, b) >= 0) return big_sum_abs(a, b, 1, a.sign);
    return big_sum_abs(b, a, 1, b.sign);
}

static inline big big_sub(big a, big b) { return big_add(a, big_neg(b)); }

static inline big big_mul(big a, big b) {
    int32_t i, j, count = a.count + b.count;
    uint32_t *limb;
    if (a.sign == 0 || b.sign == 0) return big_zero();
    limb = rat_limbs((size_t)count);
    memset(limb, 0, (size_t)count * sizeof *limb);
    for (i = 0; i < a.count; i++) {
        uint64_t carry = 0;
        for (j = 0; j < b.count; j++) {
            carry += (uint64_t)a.limb[i] * b.limb[j] + limb[i + j]; /* (2^32 - 1)^2 + 2 (2^32 - 1) = 2^64 - 1 */
            limb[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        limb[i + b.count] = (uint32_t)carry;
    }
    return big_normalised(limb, count, a.exponent + b.exponent, a.sign * b.sign);
}

static inline int big_compare(big a, big b) { return big_sign(big_sub(a, b)); }

/* x 2^power */
static inline big big_scale(big x, int power) {
    big two = big_from_double(ldexp(1.0, power));
    return big_mul(x, two);
}

/* x = mantissa 2^power with 0.5 <= |mantissa| < 1, the mantissa cut off after 53 bits; 0 and 0 for zero */
static inline double big_frexp(big x, int *power) {
    uint64_t high;
    double mantissa;
    int shift = 0;
    *power = 0;
    if (x.sign == 0) return 0.0;
    high = (uint64_t)big_limb(x, big_top(x) - 1) << 32 | big_limb(x, big_top(x) - 2);
    while (!(high >> (63 - shift) & 1)) shift++;
    if (shift > 0) high = high << shift | big_limb(x, big_top(x) - 3) >> (32 - shift);
    mantissa = ldexp((double)(high >> 11), -53);
    *power = 32 * big_top(x) - shift;
    return x.sign * mantissa;
}

/* Rounded toward zero (exact where a double can hold it). */
static inline double big_to_double(big x) {
    int power;
    double mantissa = big_frexp(x, &power);
    return ldexp(mantissa, power);
}

/* ---- determinants ---- */

/* a b - c d */
static inline big big_det2(big a, big b, big c, big d) { return big_sub(big_mul(a, d), big_mul(b, c)); }

/* determinant of the rows a, b, c */
static inline big big_det3(const big a[3], const big b[3], const big c[3]) {
    big x = big_mul(a[0], big_det2(b[1], b[2], c[1], c[2]));
    big y = big_mul(a[1], big_det2(b[0], b[2], c[0], c[2]));
    big z = big_mul(a[2], big_det2(b[0], b[1], c[0], c[1]));
    return big_add(big_sub(x, y), z);
}

static inline void big_cross(const big a[3], const big b[3], big result[3]) {
    result[0] = big_det2(a[1], a[2], b[1], b[2]);
    result[1] = big_det2(a[2], a[0], b[2], b[0]);
    result[2] = big_det2(a[0], a[1], b[0], b[1]);
}

static inline big big_dot(const big a[3], const big b[3]) {
    return big_add(big_add(big_mul(a[0], b[0]), big_mul(a[1], b[1])), big_mul(a[2], b[2]));
}

static inline void big_vector(const double x[3], big result[3]) {
    int k;
    for (k = 0; k < 3; k++) result[k] = big_from_double(x[k]);
}

static inline void big_difference(const double a[3], const double b[3], big result[3]) {
    int k;
    for (k = 0; k < 3; k++) result[k] = big_sub(big_from_double(a[k]), big_from_double(b[k]));
}

/* det(b - a, c - a, d - a): six times the volume of the tetrahedron, > 0 where d sees a, b, c clockwise */
static inline big big_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    big u[3], v[3], w[3];
    big_difference(b, a, u);
    big_difference(c, a, v);
    big_difference(d, a, w);
    return big_det3(u, v, w);
}

/* det(b - a, c - a): twice the area of the triangle, > 0 where it runs counter-clockwise */
static inline big big_orient2d(const double a[2], const double b[2], const double c[2]) {
    big ax = big_from_double(a[0]), ay = big_from_double(a[1]);
    big ux = big_sub(big_from_double(b[0]), ax), uy = big_sub(big_from_double(b[1]), ay);
    big vx = big_sub(big_from_double(c[0]), ax), vy = big_sub(big_from_double(c[1]), ay);
    return big_det2(ux, uy, vx, vy);
}

/* ---- rationals ---- */
typedef struct rat {
    big num;
    big den; /* > 0 */
} rat;

static inline rat rat_ratio(big num, big den) {
    rat x;
    if (den.sign == 0) rat_stop("division by zero");
    x.num = den.sign < 0 ? big_neg(num) : num;
    x.den = big_abs(den);
    return x;
}

static inline rat rat_from_big(big x) { return rat_ratio(x, big_from_double(1.0)); }
static inline rat rat_from_double(double x) { return rat_from_big(big_from_double(x)); }
static inline rat rat_from_int(int32_t x) { return rat_from_big(big_from_int(x)); }

static inline rat rat_add(rat a, rat b) {
    if (big_compare_abs(a.den, b.den) == 0) return rat_ratio(big_add(a.num, b.num), a.den);
    return rat_ratio(big_add(big_mul(a.num, b.den), big_mul(b.num, a.den)), big_mul(a.den, b.den));
}

static inline rat rat_neg(rat a) {
    a.num = big_neg(a.num);
    return a;
}
static inline rat rat_abs(rat a) {
    a.num = big_abs(a.num);
    return a;
}
static inline rat rat_sub(rat a, rat b) { return rat_add(a, rat_neg(b)); }
static inline rat rat_mul(rat a, rat b) { return rat_ratio(big_mul(a.num, b.num), big_mul(a.den, b.den)); }
static inline rat rat_div(rat a, rat b) { return rat_ratio(big_mul(a.num, b.den), big_mul(a.den, b.num)); }
static inline int rat_sign(rat a) { return a.num.sign; }
static inline int rat_compare(rat a, rat b) { return big_compare(big_mul(a.num, b.den), big_mul(b.num, a.den)); }

/* Within 4 units of the last place: cut off twice, divided once. */
static inline double rat_to_double(rat a) {
    int p, q;
    double num = big_frexp(a.num, &p), den = big_frexp(a.den, &q);
    return ldexp(num / den, p - q);
}

#endif /* GXFEM_TESTS_RATIONAL_H */
