/* sensor/radar/radar_preset.c: reads rows of etc/radars.csv or of a table like it. */
#include "sensor/radar/radar_preset.h"

#include "render/scattering/scatter.h"

enum {
    CENTRE,
    BANDWIDTH,
    SAMPLES,
    PULSES,
    REPEAT,
    PULSE,
    POWER,
    LOSS,
    DISH,
    TAPER,
    NOISE_FIGURE,
    PHASE_NOISE,
    IQ_GAIN,
    IQ_PHASE,
    BITS,
    PFA,
    COMPENSATED,
    FAR,
    MTI,
    numbers
};

static const struct {
    const char *name;
    double      low, high;
} number[numbers] = {
    [CENTRE] = {"centre_ghz", 1, 300},
    [BANDWIDTH] = {"bandwidth_mhz", 0.1, 20000},
    [SAMPLES] = {"samples", 8, 65536},
    [PULSES] = {"pulses", 2, 4096},
    [REPEAT] = {"repeat_khz", 0.01, 10000},
    [PULSE] = {"pulse_us", 0.001, 100000},
    [POWER] = {"power_w", 1e-6, 1e9},
    [LOSS] = {"loss_db", 0, 60},
    [DISH] = {"dish_m", 0.01, 50},
    [TAPER] = {"taper", 0, 2},
    [NOISE_FIGURE] = {"noise_figure_db", 0, 40},
    [PHASE_NOISE] = {"phase_noise_deg", 0, 90},
    [IQ_GAIN] = {"iq_gain_db", -6, 6},
    [IQ_PHASE] = {"iq_phase_deg", -45, 45},
    [BITS] = {"bits", 0, 24},
    [PFA] = {"pfa", 1e-15, 0.5},
    [COMPENSATED] = {"compensated", 0, 1},
    [FAR] = {"far_km", 0, 500},
    [MTI] = {"mti", 2, 3},
};

/* Bandwidth times the time of a profile, Hz s: 1000 m/s of path then bend the phase by 52 rad, which echo.h bears. */
static const double most_bend = 1e7;

static Status refuse(const Table *t, int row, const char *column, const char *value, const char *accepted)
{
    log_error("radars: %s:%d: %s: '%s' is not accepted; accepted: %s", t->path, t->line[row + 1], column, value,
              accepted);
    return STATUS_BAD_VALUE;
}

static Status read_window(Window *out, const Table *t, int row, const char *name)
{
    const char *text = table_text(t, row, table_column(t, name)), *accepted = window_parse(out, text);
    return accepted ? refuse(t, row, name, text, accepted) : STATUS_OK;
}

/* Checks what each kind of waveform requires of the columns together. */
static Status check_waveform(const Table *t, int row, const Waveform *w, double far_m, int mti_rows)
{
    char         accepted[96];
    const double most_s = 1 / (w->kind == WAVEFORM_STEPPED ? w->repeat_hz * w->samples : w->repeat_hz);
    if (w->pulse_s > most_s * (1 + 1e-12))
        return refuse(t, row, "pulse_us", table_text(t, row, table_column(t, "pulse_us")), "up to 1 / repeat_khz");
    if (w->kind == WAVEFORM_PULSE_DOPPLER && fabs(w->repeat_hz * w->samples / w->bandwidth_hz - 1) > 1e-9) {
        snprintf(accepted, sizeof accepted, "for pulse_doppler samples times repeat_khz: %.9g",
                 1e-6 * w->repeat_hz * w->samples);
        return refuse(t, row, "bandwidth_mhz", table_text(t, row, table_column(t, "bandwidth_mhz")), accepted);
    }
    const double long_s = waveform_step_s(w) * w->samples;
    if (w->bandwidth_hz * long_s > most_bend) {
        snprintf(accepted, sizeof accepted, "up to %.4g, for a profile that takes %.4g ms", 1e-6 * most_bend / long_s,
                 1e3 * long_s);
        return refuse(t, row, "bandwidth_mhz", table_text(t, row, table_column(t, "bandwidth_mhz")), accepted);
    }
    if (mti_rows > w->pulses) return refuse(t, row, "mti", table_text(t, row, table_column(t, "mti")), "up to pulses");
    if (far_m > 0 && !isfinite(waveform_fold_m(w)))
        return refuse(t, row, "far_km", table_text(t, row, table_column(t, "far_km")), "0, for stepped and fmcw");
    return STATUS_OK;
}

static Status read_row(RadarPreset *out, const Table *t, int row)
{
    static const char *const words[] = {"name", "waveform", "transmit", "range_window", "doppler_window", "source"};
    int                      column[numbers];
    double                   x[numbers];
    RadarPreset              p = {.receiver.noise_counts = 1};
    if (!table_columns(column, t, words, sizeof words / sizeof *words, "radars")) return STATUS_BAD_VALUE;
    for (int i = 0; i < numbers; i++) {
        if (!table_columns(&column[i], t, &number[i].name, 1, "radars")) return STATUS_BAD_VALUE;
        const Status status = table_number(&x[i], t, row, column[i], number[i].low, number[i].high);
        if (status != STATUS_OK) return status;
    }
    static const struct {
        int         which;
        bool        even;
        const char *accepted;
    } whole[] = {{SAMPLES, true, "an even number"}, {PULSES, true, "an even number"},
                 {TAPER, false, "0, 1 or 2"},       {BITS, false, "0, or a whole number in 2 .. 24"},
                 {COMPENSATED, false, "0 or 1"},    {MTI, false, "2 or 3"}};
    for (size_t i = 0; i < sizeof whole / sizeof *whole; i++) {
        const double value = x[whole[i].which];
        if (fmod(value, whole[i].even ? 2 : 1) != 0 || (whole[i].which == BITS && value == 1))
            return refuse(t, row, number[whole[i].which].name, table_text(t, row, column[whole[i].which]),
                          whole[i].accepted);
    }
    if (x[SAMPLES] * x[PULSES] > 1 << 22)
        return refuse(t, row, "pulses", table_text(t, row, column[PULSES]), "samples times pulses up to 4194304");
    if (x[BANDWIDTH] > 500 * x[CENTRE])
        return refuse(t, row, "bandwidth_mhz", table_text(t, row, column[BANDWIDTH]), "up to half of centre_ghz");
    const char *waveform = table_text(t, row, table_column(t, "waveform"));
    int         kind = 0;
    while (kind < waveform_kinds && strcmp(waveform, waveform_name[kind]) != 0) kind++;
    if (kind == waveform_kinds) return refuse(t, row, "waveform", waveform, "lfm, stepped, pulse_doppler or fmcw");
    const char *transmit = table_text(t, row, table_column(t, "transmit"));
    if (strcmp(transmit, "h") != 0 && strcmp(transmit, "v") != 0) return refuse(t, row, "transmit", transmit, "h or v");

    snprintf(p.name, sizeof p.name, "%s", table_text(t, row, table_column(t, "name")));
    p.transmits_h = *transmit == 'h';
    p.wave = (Waveform){.kind = (WaveformKind)kind,
                        .uncompensated = x[COMPENSATED] == 0,
                        .centre_hz = 1e9 * x[CENTRE],
                        .bandwidth_hz = 1e6 * x[BANDWIDTH],
                        .pulse_s = 1e-6 * x[PULSE],
                        .repeat_hz = 1e3 * x[REPEAT],
                        .samples = (int)x[SAMPLES],
                        .pulses = (int)x[PULSES]};
    if (p.wave.kind == WAVEFORM_STEPPED) p.wave.repeat_hz /= x[SAMPLES]; /* of bursts */
    p.far_m = 1e3 * x[FAR];
    p.mti_rows = (int)x[MTI];
    p.antenna = (Antenna){.diameter_m = x[DISH], .taper = (int)x[TAPER], .wavelength_m = light_mps / p.wave.centre_hz};
    p.receiver.noise_figure = pow(10, x[NOISE_FIGURE] / 10);
    p.receiver.phase_noise_rad = x[PHASE_NOISE] * rad_per_deg;
    p.receiver.iq_gain = pow(10, x[IQ_GAIN] / 20) - 1;
    p.receiver.iq_phase_rad = x[IQ_PHASE] * rad_per_deg;
    p.receiver.bits = (int)x[BITS];
    p.power_w = x[POWER];
    p.loss = pow(10, x[LOSS] / 10);
    p.pfa = x[PFA];
    Status status = check_waveform(t, row, &p.wave, p.far_m, p.mti_rows);
    if (status == STATUS_OK) status = read_window(&p.range_window, t, row, "range_window");
    if (status == STATUS_OK) status = read_window(&p.doppler_window, t, row, "doppler_window");
    if (status == STATUS_OK) *out = p;
    return status;
}

Status radar_preset_read(RadarPreset *out, const char *path, const char *name)
{
    Table  t;
    Status status = table_open(&t, path);
    if (status != STATUS_OK) return status;
    const int column = table_column(&t, "name");
    status = STATUS_BAD_VALUE;
    if (column < 0) {
        log_error("radars: %s: no column name", path);
    } else {
        int row = 0;
        while (row < t.rows && strcmp(table_text(&t, row, column), name) != 0) row++;
        if (row < t.rows) {
            status = read_row(out, &t, row);
        } else {
            WordMeant meant = word_meant(name);
            char      names[400] = "";
            size_t    n = 0;
            for (int i = 0; i < t.rows; i++) word_consider(&meant, table_text(&t, i, column));
            word_consider(&meant, "none");
            for (int i = 0; i < t.rows && n + 40 < sizeof names; i++)
                n += (size_t)snprintf(names + n, sizeof names - n, "%s%.32s", i ? ", " : "", table_text(&t, i, column));
            log_error("radars: '%s' is no row of %s; it has %s%s", name, path, names, word_hint(&meant));
        }
    }
    table_close(&t);
    return status;
}

Status radar_preset_check(const char *path)
{
    Table  t;
    Status status = table_open(&t, path);
    if (status != STATUS_OK) return status;
    RadarPreset p;
    for (int row = 0; row < t.rows && status == STATUS_OK; row++) status = read_row(&p, &t, row);
    table_close(&t);
    return status;
}
