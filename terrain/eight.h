/* terrain/eight.h: eight samples at once, in the words that the loops over blocks of samples share. + - * / work on an
 * Eight as they do on a float; what a lane gets never hangs on its neighbours. */
#ifndef TERRAIN_EIGHT_H
#define TERRAIN_EIGHT_H

#include "pitviper.h"

#include <immintrin.h>

typedef __m256  Eight;      /* floats; of comparisons: all bits where true */
typedef __m256i EightInt;   /* int32_t */

static inline Eight eight_all(double x) { return _mm256_set1_ps((float)x); }
static inline Eight eight_load(const float *p) { return _mm256_loadu_ps(p); }
static inline void  eight_store(float *p, Eight x) { _mm256_storeu_ps(p, x); }
static inline Eight eight_fma(Eight a, Eight b, Eight c) { return _mm256_fmadd_ps(a, b, c); } /* a b + c */
/* NaN in a becomes b. */
static inline Eight eight_min(Eight a, Eight b) { return _mm256_min_ps(a, b); }
static inline Eight eight_max(Eight a, Eight b) { return _mm256_max_ps(a, b); }
static inline Eight eight_clamp(Eight x, double low, double high)
{
    return eight_min(eight_max(x, eight_all(low)), eight_all(high));
}
static inline Eight eight_sqrt(Eight x) { return _mm256_sqrt_ps(x); }
static inline Eight eight_abs(Eight x) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), x); }
static inline Eight eight_floor(Eight x) { return _mm256_floor_ps(x); }
static inline Eight eight_mix(Eight a, Eight b, Eight t) { return eight_fma(t, b - a, a); }
static inline Eight eight_less(Eight a, Eight b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
static inline Eight eight_more(Eight a, Eight b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
static inline Eight eight_and(Eight a, Eight b) { return _mm256_and_ps(a, b); }
static inline Eight eight_or(Eight a, Eight b) { return _mm256_or_ps(a, b); }
static inline Eight eight_but(Eight a, Eight not_b) { return _mm256_andnot_ps(not_b, a); }
static inline Eight eight_pick(Eight mask, Eight yes, Eight no) { return _mm256_blendv_ps(no, yes, mask); }
static inline unsigned eight_bits(Eight mask) { return (unsigned)_mm256_movemask_ps(mask); }
static inline Eight eight_mask(unsigned bits)
{
    const EightInt bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)bits), bit), bit));
}
static inline Eight eight_of_doubles(const double *p)
{
    return _mm256_set_m128(_mm256_cvtpd_ps(_mm256_loadu_pd(p + 4)), _mm256_cvtpd_ps(_mm256_loadu_pd(p)));
}
static inline Eight    eight_of_ints(EightInt i) { return _mm256_cvtepi32_ps(i); }
static inline EightInt eight_to_ints(Eight x) { return _mm256_cvttps_epi32(x); } /* towards 0 */
static inline EightInt eight_int(int i) { return _mm256_set1_epi32(i); }
static inline EightInt eight_of_bytes(const uint8_t *p)
{
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)p));
}
static inline Eight eight_gather(const float *p, EightInt at) { return _mm256_i32gather_ps(p, at, 4); }

/* Rows of eight to columns of eight, in place. */
static inline void eight_turn(Eight r[8])
{
    Eight a[8], b[8];
    for (int k = 0; k < 8; k += 2) {
        a[k] = _mm256_unpacklo_ps(r[k], r[k + 1]);
        a[k + 1] = _mm256_unpackhi_ps(r[k], r[k + 1]);
    }
    for (int k = 0; k < 8; k += 4)
        for (int half = 0; half < 2; half++) {
            b[k + 2 * half] = _mm256_shuffle_ps(a[k + half], a[k + 2 + half], 0x44);
            b[k + 2 * half + 1] = _mm256_shuffle_ps(a[k + half], a[k + 2 + half], 0xee);
        }
    for (int k = 0; k < 4; k++) {
        r[k] = _mm256_permute2f128_ps(b[k], b[k + 4], 0x20);
        r[k + 4] = _mm256_permute2f128_ps(b[k], b[k + 4], 0x31);
    }
}

/* 2^x for x < 128, relative error below 2e-7, exact at 0; below -126 as there. Minimax over half a step either way. */
static inline Eight eight_exp2(Eight x)
{
    x = eight_max(x, eight_all(-126));
    const Eight n = _mm256_round_ps(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC), f = x - n;
    Eight p = eight_fma(eight_all(0.0013264723896), f, eight_all(0.0096715128699));
    p = eight_fma(p, f, eight_all(0.0555073375424));
    p = eight_fma(p, f, eight_all(0.2402224208036));
    p = eight_fma(p, f, eight_all(0.6931469775915));
    p = eight_fma(p, f, eight_all(1));
    return _mm256_castsi256_ps(
        _mm256_add_epi32(_mm256_castps_si256(p), _mm256_slli_epi32(_mm256_cvtps_epi32(n), 23)));
}

#endif
