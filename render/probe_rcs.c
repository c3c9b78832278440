/* render/probe_rcs.c: `pitviper probe rcs`: the scattered field of a target for rows of CSV. */
#include "render/probe_private.h"

#include "render/radar/given_signature.h"
#include "render/radar/radar_model.h"
#include "render/radar/total_field.h"

#include <stdlib.h>

typedef struct RcsProbe {
    RadarMaterials materials;
    Pool          *pool;
    RadarModel    *model;     /* of the last row; NULL: none */
    GivenSignature *given;    /* likewise, of a target given:FILE */
    char           name[512];
    double         sag_m;
    TotalField     field;
} RcsProbe;

static void drop_model(RcsProbe *p)
{
    if (p->model) radar_model_close(p->model);
    free(p->model);
    p->model = NULL;
    given_signature_close(p->given);
    p->given = NULL;
}

void rcs_probe_close(void *state)
{
    RcsProbe *p = state;
    drop_model(p);
    total_field_free(&p->field);
    pool_destroy(p->pool);
    radar_materials_close(&p->materials);
    free(p);
}

Status rcs_probe_open(void **state, int argc, char **argv)
{
    (void)argv;
    if (argc > 1) {
        log_error("rcs: usage: probe rcs: it takes no arguments");
        return STATUS_BAD_VALUE;
    }
    RcsProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = radar_materials_load(&p->materials);
    if (status == STATUS_OK) status = pool_create(&p->pool, thread_processors());
    if (status == STATUS_OK) *state = p;
    else rcs_probe_close(p);
    return status;
}

/* The target of a row; that of the row before where it is the same and as fine as it must be. */
static const char *take_model(RcsProbe *p, const char *name, double sag_m)
{
    const char *given = given_signature_path(name);
    if ((p->given || (p->model && p->sag_m == sag_m)) && strcmp(p->name, name) == 0) return NULL;
    drop_model(p);
    if (snprintf(p->name, sizeof p->name, "%s", name) >= (int)sizeof p->name) return "the target's name is too long";
    p->sag_m = sag_m;
    if (given)
        return given_signature_open(&p->given, given) == STATUS_OK ? NULL
                                                                   : "no such signature, or it is broken (see the log)";
    p->model = calloc(1, sizeof *p->model);
    if (!p->model) return "out of memory";
    if (radar_model_open(p->model, name, &p->materials, sag_m) == STATUS_OK) return NULL;
    free(p->model);
    p->model = NULL;
    return "no such target, or it is broken (see the log)";
}

static const char *trace(ScatterMatrix *s, RcsProbe *p, const ScatterAntenna *tx, const ScatterAntenna *rx, double f_hz)
{
    TubeConfig config = tubes_default_config(f_hz);
    config.polygon_faces = polygon_faces_few;
    const Status status = total_field_trace(&p->field, p->model->target, tx, rx, &config, true, p->pool);
    if (status == STATUS_NO_MEMORY) return "out of memory";
    if (status != STATUS_OK) return "too near or too large (see the log)";
    return total_field_sweep(s, 1, f_hz, 0, &p->field, NULL, NULL, p->pool) == STATUS_OK ? NULL : "out of memory";
}

static const char *look_up(ScatterMatrix *s, const RcsProbe *p, const ScatterAntenna *antenna, double f_hz,
                           bool bistatic)
{
    if (bistatic) return "a given signature is monostatic: leave rx_az_deg and rx_el_deg empty";
    if (!given_signature_knows(p->given, antenna, f_hz))
        return "the given signature ends before this look and frequency";
    given_signature_field(s, p->given, antenna, f_hz);
    return NULL;
}

const char *rcs_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    RcsProbe      *p = state;
    ScatterAntenna tx, rx;
    ScatterMatrix  s;
    const double   f_hz = in[1].number * 1e9, range_m = isnan(in[4].number) ? INFINITY : in[4].number;
    const bool     bistatic = !isnan(in[5].number) || !isnan(in[6].number);
    if (!(f_hz >= 1e8 && f_hz <= 3e11)) return "f_ghz must be in 0.1 .. 300";
    if (!(fabs(in[2].number) <= 720 && fabs(in[3].number) <= 90)) return "az_deg must be within 720, el_deg within 90";
    if (!(range_m > 0)) return "range_m must be above 0";
    if (bistatic && !(fabs(in[5].number) <= 720 && fabs(in[6].number) <= 90))
        return "rx_az_deg must be within 720 and rx_el_deg within 90, or both empty";
    const char *wrong = take_model(p, in[0].text, radar_sag_m(f_hz));
    if (wrong) return wrong;
    radar_look(&tx, in[2].number * rad_per_deg, in[3].number * rad_per_deg, range_m);
    rx = tx;
    if (bistatic) radar_look(&rx, in[5].number * rad_per_deg, in[6].number * rad_per_deg, range_m);
    wrong = p->given ? look_up(&s, p, &tx, f_hz, bistatic) : trace(&s, p, &tx, &rx, f_hz);
    if (wrong) return wrong;
    const double complex value[4] = {s.hh, s.hv, s.vh, s.vv};
    for (int i = 0; i < 4; i++) {
        out[i].number = value[i] == 0 ? NAN : rcs_dbsm(value[i]);
        out[4 + 2 * i].number = creal(value[i]);
        out[5 + 2 * i].number = cimag(value[i]);
    }
    return NULL;
}
