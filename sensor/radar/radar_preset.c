/* sensor/radar/radar_preset.c: reads rows of etc/radars.csv or of a table like it. */
#include "sensor/radar/radar_preset.h"

#include "pitviper_table.h"
#include "render/scattering/scatter.h"

/* A row as it is in the file. */
typedef struct Row {
    RadarPreset p;
    const char *name, *source;
    double      centre_ghz, bandwidth_mhz, loss_db, noise_figure_db, iq_gain_db;
    int         transmit, compensated;
} Row;

#define FIELD(member) TABLE_AT(Row, member)

static const char *parse_window(void *out, const char *text) { return window_parse(out, text); }

static const TableColumn columns[] = {
    {"name", .type = TABLE_CELL, FIELD(name)},
    {"source", .type = TABLE_CELL, FIELD(source)},
    {"waveform", TABLE_CHOICE, FIELD(p.wave.kind), .choices = "lfm, stepped, pulse_doppler, fmcw",
     .absent = TABLE_LATER, .otherwise = WAVEFORM_LFM},
    {"transmit", TABLE_CHOICE, FIELD(transmit), .choices = "h, v"},
    {"range_window", TABLE_OWN, FIELD(p.range_window), .parse = parse_window},
    {"doppler_window", TABLE_OWN, FIELD(p.doppler_window), .parse = parse_window},
    {"centre_ghz", TABLE_DOUBLE, FIELD(centre_ghz), .low = 1, .high = 300},
    {"bandwidth_mhz", TABLE_DOUBLE, FIELD(bandwidth_mhz), .low = 0.1, .high = 20000},
    {"samples", TABLE_INT, FIELD(p.wave.samples), .low = 8, .high = 65536},
    {"pulses", TABLE_INT, FIELD(p.wave.pulses), .low = 2, .high = 4096},
    {"repeat_khz", TABLE_DOUBLE, FIELD(p.wave.repeat_hz), .low = 0.01, .high = 10000, .unit = 1e3},
    {"pulse_us", TABLE_DOUBLE, FIELD(p.wave.pulse_s), .low = 0.001, .high = 100000, .unit = 1e-6},
    {"power_w", TABLE_DOUBLE, FIELD(p.power_w), .low = 1e-6, .high = 1e9},
    {"loss_db", TABLE_DOUBLE, FIELD(loss_db), .low = 0, .high = 60},
    {"dish_m", TABLE_DOUBLE, FIELD(p.antenna.diameter_m), .low = 0.01, .high = 50},
    {"taper", TABLE_INT, FIELD(p.antenna.taper), .low = 0, .high = 2},
    {"noise_figure_db", TABLE_DOUBLE, FIELD(noise_figure_db), .low = 0, .high = 40},
    {"phase_noise_deg", TABLE_DOUBLE, FIELD(p.receiver.phase_noise_rad), .low = 0, .high = 90, .unit = rad_per_deg},
    {"iq_gain_db", TABLE_DOUBLE, FIELD(iq_gain_db), .low = -6, .high = 6},
    {"iq_phase_deg", TABLE_DOUBLE, FIELD(p.receiver.iq_phase_rad), .low = -45, .high = 45, .unit = rad_per_deg},
    {"bits", TABLE_INT, FIELD(p.receiver.bits), .low = 0, .high = 24},
    {"pfa", TABLE_DOUBLE, FIELD(p.pfa), .low = 1e-15, .high = 0.5},
    {"compensated", TABLE_INT, FIELD(compensated), .low = 0, .high = 1, .absent = TABLE_LATER, .otherwise = 1},
    {"far_km", TABLE_DOUBLE, FIELD(p.far_m), .low = 0, .high = 500, .unit = 1e3, .absent = TABLE_LATER},
    {"mti", TABLE_INT, FIELD(p.mti_rows), .low = 2, .high = 3, .absent = TABLE_LATER, .otherwise = 2},
};
static const TableFormat format = {"radars", columns, sizeof columns / sizeof *columns,
                                   .next = "etc/radars.csv explains the columns"};

/* Bandwidth times the time of a profile, Hz s: 1000 m/s of path then bend the phase by 52 rad, which echo.h bears. */
static const double most_bend = 1e7;

/* Checks what each kind of waveform requires of the columns together. */
static Status check_waveform(const TableRows *rows, int row, const RadarPreset *p)
{
    const Waveform *w = &p->wave;
    const double    most_s = 1 / (w->kind == WAVEFORM_STEPPED ? w->repeat_hz * w->samples : w->repeat_hz);
    if (w->pulse_s > most_s * (1 + 1e-12)) return table_rows_refuse(rows, row, "pulse_us", "up to 1 / repeat_khz");
    if (w->kind == WAVEFORM_PULSE_DOPPLER && fabs(w->repeat_hz * w->samples / w->bandwidth_hz - 1) > 1e-9)
        return table_rows_refuse(rows, row, "bandwidth_mhz", "for pulse_doppler samples times repeat_khz: %.9g",
                                 1e-6 * w->repeat_hz * w->samples);
    const double long_s = waveform_step_s(w) * w->samples;
    if (w->bandwidth_hz * long_s > most_bend)
        return table_rows_refuse(rows, row, "bandwidth_mhz", "up to %.4g, for a profile that takes %.4g ms",
                                 1e-6 * most_bend / long_s, 1e3 * long_s);
    if (p->mti_rows > w->pulses) return table_rows_refuse(rows, row, "mti", "up to pulses");
    if (p->far_m > 0 && !isfinite(waveform_fold_m(w)))
        return table_rows_refuse(rows, row, "far_km", "0, for stepped and fmcw");
    return STATUS_OK;
}

static Status read_row(RadarPreset *out, const TableRows *rows, int number)
{
    Row    row = {.p = {.receiver.noise_counts = 1}};
    Status status = table_rows_get(&row, rows, number);
    if (status != STATUS_OK) return status;
    RadarPreset *p = &row.p;
    Waveform    *w = &p->wave;
    if (w->samples % 2) return table_rows_refuse(rows, number, "samples", "an even number");
    if (w->pulses % 2) return table_rows_refuse(rows, number, "pulses", "an even number");
    if (p->receiver.bits == 1) return table_rows_refuse(rows, number, "bits", "0, or a whole number in 2 .. 24");
    if ((double)w->samples * w->pulses > 1 << 22)
        return table_rows_refuse(rows, number, "pulses", "samples times pulses up to 4194304");
    if (row.bandwidth_mhz > 500 * row.centre_ghz)
        return table_rows_refuse(rows, number, "bandwidth_mhz", "up to half of centre_ghz");

    snprintf(p->name, sizeof p->name, "%s", row.name);
    p->transmits_h = row.transmit == 0;
    w->uncompensated = row.compensated == 0;
    w->centre_hz = 1e9 * row.centre_ghz;
    w->bandwidth_hz = 1e6 * row.bandwidth_mhz;
    if (w->kind == WAVEFORM_STEPPED) w->repeat_hz /= w->samples; /* of bursts */
    p->antenna.wavelength_m = light_mps / w->centre_hz;
    p->receiver.noise_figure = pow(10, row.noise_figure_db / 10);
    p->receiver.iq_gain = pow(10, row.iq_gain_db / 20) - 1;
    p->loss = pow(10, row.loss_db / 10);
    status = check_waveform(rows, number, p);
    if (status == STATUS_OK) *out = *p;
    return status;
}

Status radar_preset_read(RadarPreset *out, const char *path, const char *name)
{
    TableRows rows;
    int       row;
    Status    status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    status = table_rows_find(&row, &rows, name, "radar", "", "none");
    if (status == STATUS_OK) status = read_row(out, &rows, row);
    table_rows_close(&rows);
    return status;
}

Status radar_preset_check(const char *path)
{
    TableRows   rows;
    RadarPreset p;
    Status      status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    for (int row = 0; row < rows.table.rows && status == STATUS_OK; row++) status = read_row(&p, &rows, row);
    table_rows_close(&rows);
    return status;
}
