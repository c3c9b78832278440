#include "render/probe.h"

#include "render/planck.h"

static const char *planck_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double low_m = in[0].number * 1e-6, high_m = in[1].number * 1e-6, temp_k = in[2].number;
    if (!(low_m > 0 && high_m > low_m)) return "lo_um must be above 0 and below hi_um";
    if (!(temp_k > 0)) return "temp_k must be above 0";
    out[0].number = planck_band(low_m, high_m, temp_k, &out[1].number);
    return NULL;
}

const Probe render_probes[] = {
    {.name = "planck", .help = "in-band radiance of a black body and its derivative in temperature",
     .in = "lo_um,hi_um,temp_k", .out = "radiance_w_m2_sr,dldt", .row = planck_row},
};
const int render_probe_count = sizeof render_probes / sizeof *render_probes;
