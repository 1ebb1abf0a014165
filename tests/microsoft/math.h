/* What of C's math.h the headers use, for platforms.sh: there is no library of Microsoft's here to take it from. */
#ifndef MICROSOFT_MATH_H
#define MICROSOFT_MATH_H

#ifdef __cplusplus
extern "C" {
#endif
double cbrt(double x);
double ceil(double x);
double copysign(double x, double sign);
double cos(double x);
double exp(double x);
double fabs(double x);
float fabsf(float x);
double floor(double x);
double fmax(double x, double y);
double fmin(double x, double y);
double frexp(double x, int *exponent);
double ldexp(double x, int exponent);
double log(double x);
double log2(double x);
double sin(double x);
double sqrt(double x);
#ifdef __cplusplus
}
#endif

#define HUGE_VAL    ((double)1e308 * 10)
#define isnan(x)    ((x) != (x))
#define isfinite(x) ((x) - (x) == 0)

#endif
