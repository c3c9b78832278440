/* sensor/bench/render/precision_radar.c: the field that a target scatters: ray tubes a wavelength, their divisions at
 * edges, mirrors of a path. */
#include "sensor/bench/render/rows.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/field/radar_model.h"
#include "sensor/bench/render/precision_radar.h"
#include "sensor/bench/turn.h"

/* Rays grow as the target's outline: quick runs look at a smaller one. */
static const double tank_hz = 16e9;
static const char *const tank_look = "a look at a tank at 16 GHz", *const quick_look = "a look at a jeep at 16 GHz";
enum { looks = 6, quick_looks = 2, tank_settings = 5 };

/* Fields of a tank from some sides. */
typedef struct TankSet {
    const RadarTarget *target;
    Pool              *pool;
    TubeConfig         tubes;
    TubeHits           hits;
    int                looks;
    ScatterMatrix      s[looks];
    Status             status;
} TankSet;

static void look_at_tank(void *user)
{
    TankSet *t = user;
    for (int i = 0; i < t->looks && t->status == STATUS_OK; i++) {
        ScatterAntenna antenna;
        radar_look(&antenna, (20 + 57 * i) * rad_per_deg, (5 + 5 * i) * rad_per_deg, 2000);
        t->status = tubes_trace(&t->hits, t->target, &antenna, &antenna, &t->tubes, t->pool);
        if (t->status == STATUS_OK) t->status = field_at(&t->s[i], t->tubes.frequency_hz, &t->hits, t->pool);
    }
    bench_keep(t);
}

/* Root of the power of the difference over the power, co-polarised, %. */
static double field_error(const TankSet *got, const TankSet *want)
{
    double off = 0, whole = 0;
    for (int i = 0; i < got->looks; i++) {
        off += scatter_power(got->s[i].hh - want->s[i].hh) + scatter_power(got->s[i].vv - want->s[i].vv);
        whole += scatter_power(want->s[i].hh) + scatter_power(want->s[i].vv);
    }
    return 100 * sqrt(off / whole);
}

static TankSet tank_set(const RadarModel *model, Pool *pool, double more_rays, bool quick)
{
    TankSet t = {.target = model->target, .pool = pool, .looks = quick ? quick_looks : looks,
                 .tubes = tubes_default_config(tank_hz)};
    t.tubes.rays_per_wavelength *= more_rays;
    t.tubes.rays_per_radius *= more_rays;
    t.tubes.splits = 0; /* as signatures are made */
    return t;
}

static Status knob(Bench *bench, TankSet set[], TankSet *fine, const char *const name[], int count,
                   int by_default, const BenchTunable *tunable)
{
    BenchWork    work[tank_settings];
    BenchSetting point[tank_settings] = {0};
    look_at_tank(fine);
    Status status = fine->status;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        look_at_tank(&set[k]);
        status = set[k].status;
        work[k] = (BenchWork){look_at_tank, &set[k], set[k].looks};
        point[k] = (BenchSetting){.setting = name[k], .error = field_error(&set[k], fine),
                                  .is_default = k == by_default,
                                  .bytes = 75.0 * (double)set[k].hits.count};
    }
    if (status == STATUS_OK) bench_tunable(bench, tunable, work, point, count);
    for (int k = 0; k < count; k++) tubes_free(&set[k].hits);
    tubes_free(&fine->hits);
    return status;
}

static Status knob_tubes(Bench *bench, const RadarModel *model, Pool *pool)
{
    static const char *const name[tank_settings] = {"0.6", "1.25", "1.8", "2.5", "3.5"};
    static const double      more[tank_settings] = {0.48, 1, 1.44, 2, 2.8};
    const bool quick = bench_quick(bench);
    const int  count = quick ? tank_settings - 1 : tank_settings; /* the last has eight times the default's rays */
    TankSet    set[tank_settings], fine = tank_set(model, pool, quick ? 5 : 8, quick);
    bench_progress(bench, "ray tubes");
    for (int k = 0; k < count; k++) set[k] = tank_set(model, pool, more[k], quick);
    return knob(bench, set, &fine, name, count, 1,
                &(BenchTunable){"ray tubes a wavelength", "render/scattering/field/tubes.h", quick ? quick_look : tank_look, "%",
                                "field, rms of the looks; 6 tubes or more", 18});
}

/* At 10 GHz, where edges rule; on quick runs one look, the last setting left out. */
static Status knob_splits(Bench *bench, const RadarModel *model, Pool *pool)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"0", "1", "2", "3"};
    const bool quick = bench_quick(bench);
    const int  count = quick ? settings - 1 : settings;
    TankSet    set[settings], fine = tank_set(model, pool, 1, quick);
    bench_progress(bench, "divisions of ray tubes");
    fine.tubes.frequency_hz = tank_hz / 1.6;
    if (quick) fine.looks = 1;
    fine.tubes.splits = count;
    fine.tubes.cuts_per_radius = 1e6;
    fine.tubes.seed = 1;
    for (int k = 0; k < count; k++) {
        set[k] = fine;
        set[k].tubes.splits = k;
        set[k].tubes.seed = 0;
    }
    return knob(bench, set, &fine, name, count, 2,
                &(BenchTunable){"divisions of ray tubes at edges", "render/scattering/field/tubes.h",
                                quick ? "a look at a jeep at 10 GHz" : "a look at a tank at 10 GHz", "%",
                                "field, rms of the looks; another grid, one division more", 12});
}

static Status knob_mirrors(Bench *bench, const RadarModel *model, Pool *pool)
{
    static const char *const name[tank_settings] = {"2", "3", "5", "8", "16"};
    static const int         mirrors[tank_settings] = {2, 3, 5, 8, 16};
    const bool quick = bench_quick(bench);
    TankSet    set[tank_settings], fine = tank_set(model, pool, 1, quick);
    bench_progress(bench, "mirrors of ray tubes");
    fine.tubes.bounces = 40;
    for (int k = 0; k < tank_settings; k++) {
        set[k] = tank_set(model, pool, 1, quick);
        set[k].tubes.bounces = mirrors[k];
    }
    return knob(bench, set, &fine, name, tank_settings, 3,
                &(BenchTunable){"mirrors of a ray tube", "render/scattering/field/tubes.h", quick ? quick_look : tank_look, "%",
                                "field, rms of the looks; 40 mirrors", 13});
}

Status bench_precision_radar(Bench *bench)
{
    RadarMaterials materials = {0};
    RadarModel     model = {0};
    Pool          *pool = NULL;
    Status         status = radar_materials_load(&materials);
    if (status == STATUS_OK)
        status = radar_model_open(&model, bench_quick(bench) ? "jeep" : "tank", &materials, radar_sag_m(tank_hz));
    if (status == STATUS_OK) status = pool_create(&pool, bench_threads(bench));
    if (status == STATUS_OK) status = knob_tubes(bench, &model, pool);
    if (status == STATUS_OK) status = knob_splits(bench, &model, pool);
    if (status == STATUS_OK) status = knob_mirrors(bench, &model, pool);
    if (status == STATUS_OK) status = precision_radar_reuse(bench, model.target, pool);
    if (status == STATUS_OK) status = precision_radar_polygons(bench, &materials, pool);
    if (status != STATUS_OK) log_error("bench: precision: radar: %s", status_name(status));
    pool_destroy(pool);
    radar_model_close(&model);
    radar_materials_close(&materials);
    return status;
}
