/* sensor/radar/shot_things.c: clutter in a shot (vehicles, machines, animals, stores): a few scatterers a thing, fixed
 * to it, of the mean cross section of its shape and aspect; and what faces and things of scenery share. */
#include "sensor/radar/shot_scenery_private.h"

enum { thing_points = 12, stream_things = 0x3e200000, sources_first = 256 };

/* ---- what faces and things share ------------------------------------------------------------------- */

ClutterBand shot_band(const RadarShot *shot)
{
    const SeekerRadar *r = shot->radar;
    const double       hz = r->preset.wave.centre_hz;
    return r->in_band ? r->band : hz < 22e9 ? CLUTTER_KU : hz < 55e9 ? CLUTTER_KA : CLUTTER_W;
}

Status shot_source(int *out, RadarShot *shot, int object, uint64_t id)
{
    RadarFrame *f = shot->frame;
    /* parts of one record follow each other */
    for (int k = f->sources - 1; k >= 0 && k >= f->sources - 16; k--)
        if (f->source[k].id == id && f->source[k].object == object) {
            *out = k;
            return STATUS_OK;
        }
    if (f->sources == 0 ||
        (f->sources >= sources_first && (f->sources & (f->sources - 1)) == 0)) { /* full: twice as many */
        const size_t room = f->sources ? 2 * (size_t)f->sources : sources_first;
        RadarSource *grown = arena_alloc(shot->arena, room, sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        if (f->sources > 0) memcpy(grown, f->source, (size_t)f->sources * sizeof *grown);
        f->source = grown;
    }
    *out = f->sources;
    f->source[f->sources++] =
        (RadarSource){.id = id, .object = object, .class = shot->scenery->of->object[object].class};
    return STATUS_OK;
}

bool shot_ground_is_seen(const RadarShot *shot, const double p_ground_enu[3], const double p_enu[3])
{
    static _Thread_local Rays rays;
    static const double       slack_m = 0.5, lift_m = 0.05, own_m = 0.02;
    VisibilityCounters        counters = {0};
    double                    met_m[2], length_m[2];
    uint32_t                  met[2];
    const double             *end[2] = {p_ground_enu, p_enu};
    rays.count = 2;
    rays.columns = 0;
    rays.bent = false;
    for (int i = 0; i < 2; i++) {
        double from[3], d[3];
        memcpy(from, i ? p_ground_enu : shot->p_enu, sizeof from);
        from[2] += i ? lift_m : 0;
        v3_sub(d, end[i], from);
        length_m[i] = v3_length(d);
        v3_scale(d, 1 / fmax(length_m[i], 1e-9), d);
        rays.far_m[i] = fmax(length_m[i] - (i ? own_m : slack_m), 0);
        for (int k = 0; k < 3; k++) rays.o_enu[k][i] = from[k], rays.d_enu[k][i] = d[k];
    }
    visibility_first_range(met_m, met, shot->visibility, &rays, visibility_all_but(shot->scene->hidden), &counters);
    return !(met_m[0] < rays.far_m[0]) && !(met_m[1] < rays.far_m[1]);
}

/* ---- things ---------------------------------------------------------------------------------------- */

/* Power that a smooth surface of the model's largest part reflects, at the normal. */
static double reflectance(const RadarShot *shot, const Model *m)
{
    const SeekerRadar *r = shot->radar;
    int                largest = 0;
    RadarSurface       surface;
    double complex     te, tm;
    for (int p = 1; p < m->part_count; p++)
        if (m->part[p].triangle_count > m->part[largest].triangle_count) largest = p;
    const int known = m->part_count > 0 ? radar_materials_find(&r->materials, m->part[largest].material) : -1;
    radar_surface(&surface, &r->materials.material[known >= 0 ? known : 0], shot->preset->wave.centre_hz);
    surface.rough_m = 0;
    fresnel_surface(&te, &tm, &surface, 2 * pi_rad / shot->preset->antenna.wavelength_m, 1);
    return 0.5 * (scatter_power(te) + scatter_power(tm));
}

/* Mean cross section in a direction (body axes, unit, to the antenna). By the table, and a tenth of the area across the
 * line of sight for what the shape has not (wheel arches, grilles, handles: estimate; without it a smooth car would be
 * -17 dBsm where cars were measured at 0 and more). Without a row that of a convex body: the area times what its
 * surface reflects.
 */
static double mean_rcs_m2(const RadarShot *shot, const Model *m, const PosedEntity *posed, const double u_body[3])
{
    static const double detail = 0.1;
    const ThingRow     *row = thing_row(&shot->radar->things, m->name);
    double              area_m2 = 0;
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        area_m2 +=
            fabs(u_body[k]) * (posed->box_high[a] - posed->box_low[a]) * (posed->box_high[b] - posed->box_low[b]);
    }
    return row ? thing_rcs_m2(row, shot_band(shot), u_body) + detail * area_m2 : reflectance(shot, m) * area_m2;
}

/* Velocity of what drives, by where it is a moment before and after. */
static void velocity_of(double v_enu_mps[3], const RadarShot *shot, int object)
{
    static const double moment_s = 0.02;
    const Scenery      *s = shot->scenery->of;
    memset(v_enu_mps, 0, 3 * sizeof *v_enu_mps);
    for (int k = 0; k < s->movers; k++) {
        double p[2][3], r[9];
        if (s->mover[k].object != object) continue;
        for (int end = 0; end < 2; end++)
            scenery_pose(p[end], r, s, &s->mover[k], shot->scene->t_s + (end - 0.5) * moment_s);
        v3_sub(v_enu_mps, p[1], p[0]);
        v3_scale(v_enu_mps, 1 / moment_s, v_enu_mps);
        return;
    }
}

static Status add_thing(RadarShot *shot, int object)
{
    SeekerRadar         *r = shot->radar;
    const PosedEntity   *posed = scenery_frame_posed(shot->scenery->frame, object);
    const SceneryObject *o = &shot->scenery->of->object[object];
    const Model         *m = &shot->scenery->of->model[o->model];
    double               to[3], u_body[3], v[3], h[3], w[3], slack_m[thing_points];
    Sight                sight[thing_points];
    RadarPoint           point[thing_points];
    bool                 hidden[thing_points];
    int                  source;
    v3_sub(to, shot->p_enu, posed->centre_enu);
    if (!v3_normalize(to, to)) return STATUS_OK;
    m3_tmul_v3(u_body, posed->r_enu_from_body, to);
    const double sigma_m2 = mean_rcs_m2(shot, m, posed, u_body);
    if (!(sigma_m2 > 0 && isfinite(sigma_m2))) return STATUS_OK;
    const Status status = shot_source(&source, shot, object, o->id);
    if (status != STATUS_OK) return status;
    velocity_of(v, shot, object);
    scatter_basis(h, w, to);
    int count = 0;
    for (int n = 0; n < thing_points; n++) {
        const uint64_t first = (uint64_t)n * 16;
        const double   unit = sqrt(sigma_m2 / thing_points / (8 * pi_rad)), cross = unit * sqrt(r->things.hv);
        double         p[3], g[6];
        for (int k = 0; k < 3; k++)
            p[k] = posed->box_low[k] + (posed->box_high[k] - posed->box_low[k]) *
                                           random_uniform(o->id, stream_things, 0, first + (uint64_t)k);
        random_normals(g, 6, o->id, stream_things, 1, first);
        RadarPoint *q = &point[count];
        *q = (RadarPoint){.share = 1, .widest = shot->scenery->widest, .source = source + 1};
        m3_mul_v3(q->p_enu, posed->r_enu_from_body, p);
        v3_add(q->p_enu, q->p_enu, posed->p_enu);
        memcpy(q->v_enu_mps, v, sizeof v);
        shot_sight(&sight[count], shot, q->p_enu, 0);
        if (!sight[count].within || shot_off_axis(shot, &sight[count]) > shot->scenery->widest) continue;
        ScatterMatrix s = {.hh = unit * CMPLX(g[0], g[1]), .vv = unit * CMPLX(g[2], g[3])};
        s.hv = s.vh = cross * CMPLX(g[4], g[5]);
        scatter_turn(&s, h, w, shot->right);
        q->same = shot->preset->transmits_h ? s.hh : s.vv;
        q->other = shot->preset->transmits_h ? s.vh : s.hv;
        q->path_m = 2 * (sight[count].range_m - shot->reference_m);
        q->path_per_pulse_m =
            2 * (shot_range_rate(shot, &sight[count], v) - shot->reference_rate_mps) / shot->preset->wave.repeat_hz;
        slack_m[count++] = 2 * posed->radius_m; /* what is met so near before it is the thing itself */
    }
    if (count == 0) return STATUS_OK;
    shot_hidden(hidden, shot, shot->scene->view->p_enu, sight, slack_m, count, -1);
    RadarPoint *out = radar_points_room(&r->points, count);
    if (!out) return STATUS_NO_MEMORY;
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (!hidden[i]) out[kept++] = point[i];
    r->points.count += kept;
    shot->frame->scenery.things += kept > 0;
    return STATUS_OK;
}

Status shot_things(RadarShot *shot)
{
    const ShotScenery *s = shot->scenery;
    for (int i = 0; i < s->count; i++) {
        if (s->of->object[s->list[i]].kind != SCENERY_CLUTTER || !shot_scenery_lit(shot, s->list[i])) continue;
        const Status status = add_thing(shot, s->list[i]);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

Status shot_scenery(RadarShot *shot)
{
    if (!shot->scenery) return STATUS_OK;
    shot->scenery->widest = fmin(shot->reach * shot_null(shot), 1);
    const Status status = shot_faces(shot);
    return status == STATUS_OK ? shot_things(shot) : status;
}
