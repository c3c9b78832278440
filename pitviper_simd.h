/* pitviper_simd.h: eight floats, eight integers or four doubles at a time (AVX2 and FMA), for loops over blocks of
 * samples. + - * / work as on scalars. A lane never depends on the other lanes, so results of a block equal those of
 * single samples bit by bit. Masks, of comparisons, have all bits set in the lanes where they are true. */
#ifndef PITVIPER_SIMD_H
#define PITVIPER_SIMD_H

#include "pitviper.h"

#include <immintrin.h>

typedef __m256  F32x8;
typedef __m256i I32x8;
typedef __m256d F64x4;

/* ---- floats ------------------------------------------------------------------------------------ */

static inline F32x8 f32x8_set(double x) { return _mm256_set1_ps((float)x); }
static inline F32x8 f32x8_load(const float *p) { return _mm256_loadu_ps(p); }
static inline void  f32x8_store(float *p, F32x8 x) { _mm256_storeu_ps(p, x); }
static inline F32x8 f32x8_fma(F32x8 a, F32x8 b, F32x8 c) { return _mm256_fmadd_ps(a, b, c); } /* a b + c */
/* NaN in a becomes b. */
static inline F32x8 f32x8_min(F32x8 a, F32x8 b) { return _mm256_min_ps(a, b); }
static inline F32x8 f32x8_max(F32x8 a, F32x8 b) { return _mm256_max_ps(a, b); }
static inline F32x8 f32x8_clamp(F32x8 x, double low, double high)
{
    return f32x8_min(f32x8_max(x, f32x8_set(low)), f32x8_set(high));
}
static inline F32x8 f32x8_sqrt(F32x8 x) { return _mm256_sqrt_ps(x); }
static inline F32x8 f32x8_abs(F32x8 x) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), x); }
static inline F32x8 f32x8_floor(F32x8 x) { return _mm256_floor_ps(x); }
static inline F32x8 f32x8_lerp(F32x8 a, F32x8 b, F32x8 t) { return f32x8_fma(t, b - a, a); }
static inline F32x8 f32x8_less(F32x8 a, F32x8 b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
static inline F32x8 f32x8_at_most(F32x8 a, F32x8 b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
static inline F32x8 f32x8_greater(F32x8 a, F32x8 b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
static inline F32x8 f32x8_and(F32x8 a, F32x8 b) { return _mm256_and_ps(a, b); }
static inline F32x8 f32x8_or(F32x8 a, F32x8 b) { return _mm256_or_ps(a, b); }
static inline F32x8 f32x8_and_not(F32x8 a, F32x8 not_b) { return _mm256_andnot_ps(not_b, a); }
static inline F32x8 f32x8_select(F32x8 mask, F32x8 yes, F32x8 no) { return _mm256_blendv_ps(no, yes, mask); }
/* One bit a lane, and back. */
static inline unsigned f32x8_bits(F32x8 mask) { return (unsigned)_mm256_movemask_ps(mask); }
static inline F32x8    f32x8_mask(unsigned bits)
{
    const I32x8 bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)bits), bit), bit));
}
static inline F32x8 f32x8_of_doubles(const double *p)
{
    return _mm256_set_m128(_mm256_cvtpd_ps(_mm256_loadu_pd(p + 4)), _mm256_cvtpd_ps(_mm256_loadu_pd(p)));
}
static inline F32x8 f32x8_of_ints(I32x8 i) { return _mm256_cvtepi32_ps(i); }
static inline F32x8 f32x8_gather(const float *p, I32x8 at) { return _mm256_i32gather_ps(p, at, 4); }

/* Rows of eight to columns of eight, in place. */
static inline void f32x8_transpose(F32x8 r[8])
{
    F32x8 a[8], b[8];
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
static inline F32x8 f32x8_exp2(F32x8 x)
{
    x = f32x8_max(x, f32x8_set(-126));
    const F32x8 n = _mm256_round_ps(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC), f = x - n;
    F32x8       p = f32x8_fma(f32x8_set(0.0013264723896), f, f32x8_set(0.0096715128699));
    p = f32x8_fma(p, f, f32x8_set(0.0555073375424));
    p = f32x8_fma(p, f, f32x8_set(0.2402224208036));
    p = f32x8_fma(p, f, f32x8_set(0.6931469775915));
    p = f32x8_fma(p, f, f32x8_set(1));
    return _mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(p), _mm256_slli_epi32(_mm256_cvtps_epi32(n), 23)));
}

/* ---- integers ---------------------------------------------------------------------------------- */

static inline I32x8 i32x8_set(int i) { return _mm256_set1_epi32(i); }
static inline I32x8 i32x8_truncate(F32x8 x) { return _mm256_cvttps_epi32(x); } /* towards 0 */
static inline I32x8 i32x8_of_bytes(const uint8_t *p)
{
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)p));
}
static inline I32x8 i32x8_load(const int32_t *p) { return _mm256_loadu_si256((const __m256i *)p); }
static inline void  i32x8_store(int32_t *p, I32x8 x) { _mm256_storeu_si256((__m256i *)p, x); }
static inline I32x8 i32x8_add(I32x8 a, I32x8 b) { return _mm256_add_epi32(a, b); }
static inline I32x8 i32x8_sub(I32x8 a, I32x8 b) { return _mm256_sub_epi32(a, b); }
static inline I32x8 i32x8_mul(I32x8 a, I32x8 b) { return _mm256_mullo_epi32(a, b); } /* the low 32 bits */
static inline I32x8 i32x8_and(I32x8 a, I32x8 b) { return _mm256_and_si256(a, b); }
static inline I32x8 i32x8_xor(I32x8 a, I32x8 b) { return _mm256_xor_si256(a, b); }
static inline I32x8 i32x8_shift_right(I32x8 a, int bits) { return _mm256_srli_epi32(a, bits); }
static inline I32x8 i32x8_shift_signed(I32x8 a, int bits) { return _mm256_srai_epi32(a, bits); } /* to the right */
static inline F32x8 i32x8_equal(I32x8 a, I32x8 b) { return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)); }
static inline F32x8 i32x8_greater(I32x8 a, I32x8 b) { return _mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b)); }
static inline I32x8 i32x8_select(F32x8 mask, I32x8 yes, I32x8 no)
{
    return _mm256_blendv_epi8(no, yes, _mm256_castps_si256(mask));
}
static inline I32x8 i32x8_gather(const int32_t *p, I32x8 at) { return _mm256_i32gather_epi32(p, at, 4); }
/* Only the lanes of a mask are read; the others are 0. */
static inline I32x8 i32x8_gather_of(F32x8 mask, const int32_t *p, I32x8 at)
{
    return _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), p, at, _mm256_castps_si256(mask), 4);
}

/* ---- doubles ----------------------------------------------------------------------------------- */

static inline F64x4 f64x4_set(double x) { return _mm256_set1_pd(x); }
/* load, store: of 32-byte aligned arrays; loadu, storeu: of any. */
static inline F64x4    f64x4_load(const double *p) { return _mm256_load_pd(p); }
static inline F64x4    f64x4_loadu(const double *p) { return _mm256_loadu_pd(p); }
static inline void     f64x4_store(double *p, F64x4 x) { _mm256_store_pd(p, x); }
static inline void     f64x4_storeu(double *p, F64x4 x) { _mm256_storeu_pd(p, x); }
static inline F64x4    f64x4_min(F64x4 a, F64x4 b) { return _mm256_min_pd(a, b); } /* a < b ? a : b */
static inline F64x4    f64x4_max(F64x4 a, F64x4 b) { return _mm256_max_pd(a, b); } /* a > b ? a : b */
static inline F64x4    f64x4_sqrt(F64x4 x) { return _mm256_sqrt_pd(x); }
static inline F64x4    f64x4_abs(F64x4 x) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), x); }
static inline F64x4    f64x4_floor(F64x4 x) { return _mm256_floor_pd(x); }
static inline F64x4    f64x4_less(F64x4 a, F64x4 b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
static inline F64x4    f64x4_at_most(F64x4 a, F64x4 b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
static inline F64x4    f64x4_equal(F64x4 a, F64x4 b) { return _mm256_cmp_pd(a, b, _CMP_EQ_OQ); }
static inline F64x4    f64x4_differ(F64x4 a, F64x4 b) { return _mm256_cmp_pd(a, b, _CMP_NEQ_UQ); }
static inline F64x4    f64x4_and(F64x4 a, F64x4 b) { return _mm256_and_pd(a, b); }
static inline F64x4    f64x4_or(F64x4 a, F64x4 b) { return _mm256_or_pd(a, b); }
static inline F64x4    f64x4_and_not(F64x4 a, F64x4 not_b) { return _mm256_andnot_pd(not_b, a); }
static inline F64x4    f64x4_select(F64x4 mask, F64x4 yes, F64x4 no) { return _mm256_blendv_pd(no, yes, mask); }
static inline unsigned f64x4_bits(F64x4 mask) { return (unsigned)_mm256_movemask_pd(mask); }
static inline F64x4    f64x4_mask(unsigned bits)
{
    const __m256i bit = _mm256_setr_epi64x(1, 2, 4, 8);
    return _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x((int)bits), bit), bit));
}
static inline F64x4 f64x4_of_ints(__m128i i) { return _mm256_cvtepi32_pd(i); }
/* Lanes 0 .. 3 of floats, or 4 .. 7. */
static inline F64x4 f64x4_half(F32x8 x, int half)
{
    return _mm256_cvtps_pd(half ? _mm256_extractf128_ps(x, 1) : _mm256_castps256_ps128(x));
}

#endif
