/* sensor/bench/render/precision_radar_reuse.c: a tank's field without its edges, from a list of another aspect, and
 * from scattering centres: what each saves, and how wrong it is. */
#include "sensor/bench/render/precision_radar.h"

#include "render/scattering/signatures/centres.h"

static const double full_hz = 10e9, quick_hz = 4e9, band_hz = 500e6, bin_deg = 0.3;
enum { frequencies = 32 };

typedef struct Reuse {
    RadarTarget   *tank;
    Pool          *pool;
    double         centre_hz;
    TubeConfig     tubes;
    ScatterAntenna look, now;   /* of the list, and where the antenna is */
    bool           edges;
    TotalField     field;
    Centres        centres;
    Signature      signature;
    SignatureCells cells;
    ScatterMatrix  s[frequencies];
    Status         status;
} Reuse;

static void trace(void *user)
{
    Reuse *r = user;
    r->status = total_field_trace(&r->field, r->tank, &r->look, &r->look, &r->tubes, r->edges, r->pool);
    bench_keep(r);
}

static void sweep(void *user)
{
    Reuse *r = user;
    if (r->status == STATUS_OK)
        r->status = total_field_sweep(r->s, frequencies, r->centre_hz - 0.5 * band_hz, band_hz / (frequencies - 1),
                                      &r->field, &r->now, &r->now, r->pool);
    bench_keep(r);
}

static void gather(void *user)
{
    Reuse *r = user;
    if (r->status == STATUS_OK) r->status = signature_make(&r->signature, &r->field, NULL, &r->cells);
    if (r->status == STATUS_OK) r->status = centres_make(&r->centres, &r->signature, &r->now, &r->now, r->pool);
    bench_keep(r);
}

double precision_radar_off(const ScatterMatrix *got, const ScatterMatrix *want, int count)
{
    double apart = 0, whole = 0;
    for (int i = 0; i < count; i++) {
        apart += scatter_power(got[i].hh - want[i].hh) + scatter_power(got[i].vv - want[i].vv);
        whole += scatter_power(want[i].hh) + scatter_power(want[i].vv);
    }
    return 100 * sqrt(apart / whole);
}

static void add_row(Bench *bench, const char *what, void (*run)(void *), Reuse *r, double error, const char *against)
{
    BenchTime       time;
    const BenchWork work = {run, r, 1};
    bench_time(&time, bench, &work, 1);
    BenchRow row = bench_row_of(what, &time, "/s", 1);
    row.error = error, row.error_unit = "%", row.against = against;
    bench_add(bench, &row);
}

/* Edges left out, and waves between them. */
static void edges(Bench *bench, Reuse *r)
{
    ScatterMatrix whole[frequencies];
    const int     pairs = r->tank->pair_count;
    trace(r), sweep(r);
    memcpy(whole, r->s, sizeof whole);
    add_row(bench, "radar: a look at a tank, edges and waves between them", trace, r, 0, "itself");
    r->tank->pair_count = 0;
    trace(r), sweep(r);
    add_row(bench, "radar: the same, edges of first order", trace, r, precision_radar_off(r->s, whole, frequencies),
            "all edges");
    r->tank->pair_count = pairs;
    r->edges = false;
    trace(r), sweep(r);
    add_row(bench, "radar: the same, without edges", trace, r, precision_radar_off(r->s, whole, frequencies),
            "all edges");
    r->edges = true;
}

/* A list for an antenna elsewhere, against a list of its own. */
static void aspects(Bench *bench, Reuse *r)
{
    static const struct { const char *what; double deg; } at[] = {
        {"radar: 32 frequencies of a list 0.05 degrees away", 0.05},
        {"radar: 32 frequencies of a list 0.15 degrees away", 0.15},
        {"radar: 32 frequencies of a list 0.3 degrees away", 0.3},
        {"radar: 32 frequencies of a list 1 degree away", 1}};
    const ScatterAntenna look = r->look;
    for (int i = bench_quick(bench) ? 1 : 0; i < (bench_quick(bench) ? 3 : 4); i++) {
        ScatterMatrix own[frequencies];
        radar_look(&r->look, (20 + at[i].deg) * rad_per_deg, 10 * rad_per_deg, 2000);
        r->now = r->look;
        trace(r), sweep(r);
        memcpy(own, r->s, sizeof own);
        r->look = look;
        trace(r), sweep(r);
        add_row(bench, at[i].what, sweep, r, precision_radar_off(r->s, own, frequencies),
                "a list of its own, its grid too");
        r->now = look;
    }
}

/* Centres of cells against the hits themselves, at the edge of their bin, over the band. */
static void cells(Bench *bench, Reuse *r)
{
    static const struct { const char *what; double rad; } at[] = {
        {"radar: signature of a list, cells of 0.1 rad", 0.1}, {"radar: signature of a list, cells of 0.2 rad", 0.2},
        {"radar: signature of a list, cells of 0.4 rad", 0.4}, {"radar: signature of a list, cells of 0.8 rad", 0.8}};
    radar_look(&r->now, (20 + 0.5 * bin_deg) * rad_per_deg, 10 * rad_per_deg, 2000);
    ScatterMatrix want[frequencies], got[frequencies];
    trace(r), sweep(r);
    memcpy(want, r->s, sizeof want);
    for (int i = 0; i < 4; i++) {
        r->cells = signature_default_cells(r->centre_hz, band_hz, bin_deg * rad_per_deg, 0);
        r->cells.path_phase_rad = r->cells.across_phase_rad = at[i].rad;
        gather(r);
        memset(got, 0, sizeof got);
        for (int f = 0; f < frequencies && r->status == STATUS_OK; f++) {
            const double k = 2 * pi_rad * (r->centre_hz + band_hz * ((double)f / (frequencies - 1) - 0.5)) / light_mps;
            for (int c = 0; c < r->centres.count; c++) {
                const ScatterCentre *centre = &r->centres.centre[c];
                const double complex wave = cexp(-I * k * centre->path_m);
                got[f].hh += centre->s.hh * wave, got[f].vv += centre->s.vv * wave;
            }
        }
        add_row(bench, at[i].what, gather, r, precision_radar_off(got, want, frequencies),
                bench_quick(bench) ? "hits and edges, edge of a bin, 500 MHz at 4 GHz"
                                   : "hits and edges, edge of a bin, 500 MHz at 10 GHz");
    }
    r->now = r->look;
}

Status precision_radar_reuse(Bench *bench, RadarTarget *tank, Pool *pool)
{
    const double centre_hz = bench_quick(bench) ? quick_hz : full_hz;
    Reuse        r = {.tank = tank, .pool = pool, .centre_hz = centre_hz, .edges = true,
                      .tubes = tubes_default_config(centre_hz)};
    bench_progress(bench, "reuse of a radar's lists");
    if (bench_quick(bench)) r.tubes.splits = 0;
    radar_look(&r.look, 20 * rad_per_deg, 10 * rad_per_deg, 2000);
    r.now = r.look;
    edges(bench, &r);
    aspects(bench, &r);
    cells(bench, &r);
    total_field_free(&r.field);
    signature_free(&r.signature);
    centres_free(&r.centres);
    return r.status;
}
