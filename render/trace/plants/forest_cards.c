/* render/trace/plants/forest_cards.c: eight rays at a time against a plant's table.
 *
 * The table's direction is chosen once a plant: from the eye to its middle, or the way of rays to the sun. So nothing
 * of a ray's hit follows from the rays beside it. All arithmetic of a ray is that of floats by AVX2 and FMA, of which
 * every processor has the same bits. */
#include "render/trace/plants/forest_private.h"

/* Height in the picture from which a plant is met itself: in coarse pictures less, since a table has one direction for
 * all of the plant, from which rays to its top and foot must not be far. */
static double least_real_px(const ForestFrame *frame, const Plant *plant)
{
    const double px = forest_table_px[0] + (forest_table_px[1] - forest_table_px[0]) * plant_rank(plant);
    return smaller(px, forest_table_rad * px / forest_table_px[1] * frame->per_rad);
}

/* The coarsest level whose texels are not wider than what one ray stands for. */
static int level_of(double step_m, double ray_m)
{
    int level = 0;
    while (level < table_levels - 1 && 2 * step_m <= ray_m) level++, step_m *= 2;
    return level;
}

void card_make(Card *card, const CardRays *rays, const PlantList *list, const Plant *plant)
{
    const ForestFrame *frame = rays->frame;
    PlantTable        *table = plant->kind < PLANT_STANDING ? list->forest->table[plant->kind] : NULL;
    double             axis[3][3], scale[2], from[3], to[3], d[3], m[3][3];
    card->table = table;
    for (int c = 0; c < 3; c++) from[c] = frame->eye_enu[c] - (list->origin_enu[c] + (double)plant->p_m[c]);
    const double away_m = v3_length(from), height_m = plant_height_m(plant);
    card->real = !table || height_m * frame->per_rad >= least_real_px(frame, plant) * away_m;
    if (card->real) return;
    from[2] -= rays->bend_per_m * (from[0] * from[0] + from[1] * from[1]); /* all over the plant the same */
    plant_axes_in(axis, scale, frame, list, plant);
    for (int k = 0; k < 3; k++) {
        const double per = 1 / scale[k == 2];
        for (int c = 0; c < 3; c++) m[k][c] = axis[k][c] * per;
    }
    for (int c = 0; c < 3; c++) to[c] = rays->way_enu ? -rays->way_enu[c] : (c == 2 ? 0.5 * height_m : 0) - from[c];
    for (int k = 0; k < 3; k++) d[k] = v3_dot(m[k], to);
    card->way = plant_table_way(d);
    card->real = card->way < 0;
    if (card->real) return;

    const TableWay   *way = &table->way[card->way];
    const ShapeScene *shape = table->shape;
    const double      step_m = table->step * (scale[0] > scale[1] ? scale[0] : scale[1]);
    card->level = level_of(step_m, away_m * frame->ray_px / frame->per_rad);
    card->step_m = (float)step_m;
    card->unit = (float)(table->radius / table_depth_steps);
    const double half = 0.5 * (table_side >> card->level);
    const double middle[3] = {v3_dot(way->d, shape->centre), v3_dot(way->u, shape->centre),
                              v3_dot(way->v, shape->centre)};
    double       n[3], u[3], v[3];
    for (int c = 0; c < 3; c++) {
        n[c] = way->d[0] * m[0][c] + way->d[1] * m[1][c] + way->d[2] * m[2][c];
        u[c] = half * (way->u[0] * m[0][c] + way->u[1] * m[1][c] + way->u[2] * m[2][c]);
        v[c] = half * (way->v[0] * m[0][c] + way->v[1] * m[1][c] + way->v[2] * m[2][c]);
        card->n[c] = (float)n[c], card->u[c] = (float)u[c], card->v[c] = (float)v[c];
    }
    double at[3] = {-middle[0], half - half * middle[1], half - half * middle[2]};
    if (!rays->way_enu) at[0] += v3_dot(n, from), at[1] += v3_dot(u, from), at[2] += v3_dot(v, from);
    double low_m[3], high_m[3];
    plant_bounds(low_m, high_m, list, plant);
    for (int c = 0; c < 3; c++) {
        card->at[c] = (float)at[c];
        card->from[c] = rays->way_enu ? plant->p_m[c] : (float)from[c];
        card->low[c] = (float)low_m[c], card->high[c] = (float)high_m[c];
    }
}

static inline F32x8 dot(const float a[3], const F32x8 p[3])
{
    const F32x8 z = f32x8_fma(f32x8_set((double)a[1]), p[1], f32x8_set((double)a[0]) * p[0]);
    return f32x8_fma(f32x8_set((double)a[2]), p[2], z);
}

/* Texels of the lanes, those that are not known traced. */
static I32x8 look_up(const Card *card, I32x8 at, F32x8 lanes)
{
    const uint32_t *texels = plant_table_texels(card->table, card->way, card->level);
    I32x8           got = i32x8_gather_of(lanes, (const int32_t *)texels, at);
    unsigned        left = f32x8_bits(f32x8_and(lanes, i32x8_equal(got, i32x8_set(table_unset))));
    if (!left) return got;
    int32_t place[card_lanes], texel[card_lanes];
    i32x8_store(place, at), i32x8_store(texel, got);
    for (; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        texel[l] = (int32_t)plant_table_trace(card->table, card->way, card->level, place[l]);
    }
    return i32x8_load(texel);
}

unsigned card_aim(CardAim *out, const Card *card, const CardRays *rays, unsigned lanes)
{
    const F32x8 zero = f32x8_set(0), side = f32x8_set(table_side >> card->level);
    F32x8       o[3], d[3],
        at[3] = {f32x8_set((double)card->at[0]), f32x8_set((double)card->at[1]), f32x8_set((double)card->at[2])};
    for (int c = 0; c < 3; c++) {
        d[c] = f32x8_load(rays->d[c]);
        o[c] = f32x8_set((double)card->from[c]);
        if (rays->way_enu) o[c] = f32x8_load(rays->o[c]) - o[c];
    }
    if (rays->way_enu) at[0] += dot(card->n, o), at[1] += dot(card->u, o), at[2] += dot(card->v, o);
    /* where a ray goes through the middle plane */
    const F32x8 per = f32x8_set(1) / dot(card->n, d), middle_m = (zero - at[0]) * per;
    const F32x8 column = f32x8_fma(middle_m, dot(card->u, d), at[1]), row = f32x8_fma(middle_m, dot(card->v, d), at[2]);
    F32x8 in = f32x8_and(f32x8_mask(lanes), f32x8_and(f32x8_and(f32x8_at_most(zero, column), f32x8_less(column, side)),
                                                      f32x8_and(f32x8_at_most(zero, row), f32x8_less(row, side))));
    const unsigned through = f32x8_bits(in);
    if (!through) return 0;
    out->in = in, out->per = per, out->depth = at[0];
    for (int c = 0; c < 3; c++) out->o[c] = o[c];
    out->place =
        i32x8_add(i32x8_mul(i32x8_truncate(row), i32x8_set(table_side >> card->level)), i32x8_truncate(column));
    int32_t         place[card_lanes];
    const uint32_t *texels = plant_table_texels(card->table, card->way, card->level);
    i32x8_store(place, out->place);
    for (unsigned left = through; left; left &= left - 1) __builtin_prefetch(texels + place[__builtin_ctz(left)]);
    return through;
}

unsigned card_meets(float range_m[card_lanes], uint32_t quad[card_lanes], const Card *card, const CardRays *rays,
                    uint32_t plant, const CardAim *aim)
{
    const F32x8 zero = f32x8_set(0), per = aim->per, *o = aim->o;
    F32x8       in = aim->in;
    const I32x8 texel = look_up(card, aim->place, in);
    in = f32x8_and_not(in, i32x8_equal(texel, i32x8_set(table_nothing)));
    if (!f32x8_bits(in)) return 0;
    const F32x8 depth = f32x8_of_ints(i32x8_shift_signed(texel, table_quad_bits)) * f32x8_set((double)card->unit);
    const F32x8 range = (depth - aim->depth) * per;
    const I32x8 of = i32x8_sub(i32x8_and(texel, i32x8_set(table_quad_mask)), i32x8_set(2));
    F32x8       least = zero;
    if (rays->way_enu) { /* of its own plant, what lies clearly nearer to the sun, but for the quad that it leaves */
        const F32x8 own = i32x8_equal(i32x8_load(rays->own_plant), i32x8_set((int)plant));
        least = f32x8_and(own, f32x8_set(0.05 * (double)card->step_m));
        in = f32x8_and_not(in, f32x8_and(own, i32x8_equal(i32x8_load(rays->own_quad), of)));
    }
    in = f32x8_and(in, f32x8_less(least, range));
    for (int c = 0; c < 3; c++) {
        const F32x8 p = f32x8_fma(range, f32x8_load(rays->d[c]), o[c]);
        in = f32x8_and(in, f32x8_and(f32x8_at_most(f32x8_set((double)card->low[c]), p),
                                     f32x8_at_most(p, f32x8_set((double)card->high[c]))));
    }
    f32x8_store(range_m, range);
    i32x8_store((int32_t *)quad, of);
    return f32x8_bits(in);
}

unsigned card_near(const CardRays *rays, const float at_m[3], double reach_m, unsigned lanes)
{
    F32x8 d[3], to[3], apart = f32x8_set(0);
    for (int c = 0; c < 3; c++) {
        d[c] = f32x8_load(rays->d[c]);
        to[c] = f32x8_set((double)at_m[c]) - f32x8_load(rays->o[c]);
    }
    to[2] += f32x8_set(rays->bend_per_m) * f32x8_fma(to[0], to[0], to[1] * to[1]); /* in place of the ray's fall */
    const F32x8 square = f32x8_fma(d[2], d[2], f32x8_fma(d[1], d[1], d[0] * d[0]));
    const F32x8 nearest_m = f32x8_fma(d[2], to[2], f32x8_fma(d[1], to[1], d[0] * to[0])) / square;
    for (int c = 0; c < 3; c++) {
        const F32x8 off = to[c] - nearest_m * d[c];
        apart = f32x8_fma(off, off, apart);
    }
    return f32x8_bits(f32x8_and(f32x8_mask(lanes), f32x8_at_most(apart, f32x8_set(reach_m * reach_m))));
}
