/* sensor/detector/preset.c: reads rows of etc/sensors.csv. */
#include "sensor/detector/preset.h"

#include "pitviper_table.h"
#include "render/air/atmosphere.h"

/* A row as it is in the file. */
typedef struct Row {
    SensorPreset p;
    const char  *name, *band;
    int          exposure, scan; /* places among their words */
} Row;

#define FIELD(member) TABLE_AT(Row, member)

static const TableColumn columns[] = {
    {"name", .type = TABLE_CELL, FIELD(name)},
    {"band", .type = TABLE_CELL, FIELD(band)},
    {"exposure", TABLE_CHOICE, FIELD(exposure), .choices = "fixed, auto"},
    {"scan", TABLE_CHOICE, FIELD(scan), .choices = "stare, lines, both, columns"},
    {"width_px", TABLE_WHOLE, FIELD(p.width_px), .low = 8, .high = 8192},
    {"height_px", TABLE_WHOLE, FIELD(p.height_px), .low = 8, .high = 8192},
    {"hfov_deg", TABLE_DOUBLE, FIELD(p.hfov_deg), .low = 0.01, .high = 120},
    {"f_number", TABLE_DOUBLE, FIELD(p.photons.f_number), .low = 0.5, .high = 100},
    {"obscuration", TABLE_DOUBLE, FIELD(p.obscuration), .low = 0, .high = 0.95},
    {"pitch_um", TABLE_DOUBLE, FIELD(p.photons.pitch_m), .low = 0.5, .high = 1000, .unit = 1e-6},
    {"footprint", TABLE_DOUBLE, FIELD(p.footprint), .low = 0.1, .high = 1},
    {"transmission", TABLE_DOUBLE, FIELD(p.photons.transmission), .low = 0.001, .high = 1},
    {"qe", TABLE_DOUBLE, FIELD(p.photons.qe), .low = 0.001, .high = 1},
    {"integration_ms", TABLE_DOUBLE, FIELD(p.photons.integration_s), .low = 1e-6, .high = 1e4, .unit = 1e-3},
    {"dark_e_s", TABLE_DOUBLE, FIELD(p.dark_e_s), .low = 0, .high = 1e15},
    {"read_e", TABLE_DOUBLE, FIELD(p.photons.read_e), .low = 0, .high = 1e9},
    {"well_e", TABLE_DOUBLE, FIELD(p.photons.well_e), .low = 100, .high = 1e12},
    {"bits", TABLE_WHOLE, FIELD(p.bits), .low = 8, .high = 16},
    {"jitter_px", TABLE_DOUBLE, FIELD(p.jitter_px), .low = 0, .high = 10},
    {"tv", TABLE_DOUBLE, FIELD(p.ratio.sigma[NOISE_TV]), .low = 0, .high = 100},
    {"th", TABLE_DOUBLE, FIELD(p.ratio.sigma[NOISE_TH]), .low = 0, .high = 100},
    {"vh", TABLE_DOUBLE, FIELD(p.ratio.sigma[NOISE_VH]), .low = 0, .high = 100},
    {"t", TABLE_DOUBLE, FIELD(p.ratio.sigma[NOISE_T]), .low = 0, .high = 100},
    {"v", TABLE_DOUBLE, FIELD(p.ratio.sigma[NOISE_V]), .low = 0, .high = 100},
    {"h", TABLE_DOUBLE, FIELD(p.ratio.sigma[NOISE_H]), .low = 0, .high = 100},
    {"prnu", TABLE_DOUBLE, FIELD(p.prnu), .low = 0, .high = 0.5},
    {"line_us", TABLE_DOUBLE, FIELD(p.scan.line_s), .low = 0, .high = 1e6, .unit = 1e-6},
    {"active", TABLE_DOUBLE, FIELD(p.scan.active), .low = 0, .high = 1},
    {"ac_per_line", TABLE_DOUBLE, FIELD(p.ac_per_line), .low = 0, .high = 100},
    {"line_noise", TABLE_DOUBLE, FIELD(p.line_noise), .low = 0, .high = 100},
    {"line_noise_px", TABLE_DOUBLE, FIELD(p.line_noise_px), .low = 0, .high = 1e4},
    {"bad_share", TABLE_DOUBLE, FIELD(p.bad_share), .low = 0, .high = 0.2},
    {"bad_clustered", TABLE_DOUBLE, FIELD(p.bad_clustered), .low = 0, .high = 1},
    {"bad_patched", TABLE_DOUBLE, FIELD(p.bad_patched), .low = 0, .high = 1},
    {"tdi", TABLE_WHOLE, FIELD(p.tdi), .low = 1, .high = 1000, .absent = TABLE_LATER, .otherwise = 1},
    {"k1", TABLE_DOUBLE, FIELD(p.lens[0]), .low = -1e6, .high = 1e6, .absent = TABLE_LATER},
    {"k2", TABLE_DOUBLE, FIELD(p.lens[1]), .low = -1e9, .high = 1e9, .absent = TABLE_LATER},
    {"k3", TABLE_DOUBLE, FIELD(p.lens[2]), .low = -1e12, .high = 1e12, .absent = TABLE_LATER},
    {"p1", TABLE_DOUBLE, FIELD(p.lens[3]), .low = -1e3, .high = 1e3, .absent = TABLE_LATER},
    {"p2", TABLE_DOUBLE, FIELD(p.lens[4]), .low = -1e3, .high = 1e3, .absent = TABLE_LATER},
    {"lateral_r", TABLE_DOUBLE, FIELD(p.lateral[0]), .low = -0.02, .high = 0.02, .absent = TABLE_LATER},
    {"lateral_b", TABLE_DOUBLE, FIELD(p.lateral[1]), .low = -0.02, .high = 0.02, .absent = TABLE_LATER},
};
static const TableFormat format = {"sensors", columns, sizeof columns / sizeof *columns,
                                   .next = "etc/sensors.csv explains the columns"};

SpectralBand preset_seen(Band band, OpticalChannels optical, int channel)
{
    static const AirBand rgb[3] = {AIR_R, AIR_G, AIR_B};
    if (band == BAND_RADAR) return (SpectralBand){NAN, NAN, NULL};
    AirBand air = band == BAND_MWIR ? AIR_MWIR : band == BAND_LWIR ? AIR_LWIR : AIR_PAN;
    if (band == BAND_OPTICAL && optical == OPTICAL_NIR) air = AIR_NIR;
    if (band == BAND_OPTICAL && optical == OPTICAL_RGB && channel >= 0) air = rgb[channel];
    return channel_band(air);
}

void preset_band(double *low_m, double *high_m, Band band, OpticalChannels optical, int channel)
{
    const SpectralBand seen = preset_seen(band, optical, channel);
    *low_m = seen.low_m;
    *high_m = seen.high_m;
}

PhotonDetector preset_photons(const SensorPreset *p)
{
    PhotonDetector d = p->photons;
    const double   stages = p->tdi > 1 ? p->tdi : 1;
    d.integration_s *= stages;
    d.dark_e *= stages;
    d.read_e *= sqrt(stages);
    return d;
}

void preset_refresh(SensorPreset *p)
{
    const SpectralBand seen = preset_seen(p->band, p->optical, -1);
    p->photons.low_m = seen.low_m, p->photons.high_m = seen.high_m, p->photons.response = seen.response;
    p->photons.dark_e = p->dark_e_s * p->photons.integration_s;
    p->ratio.sigma[NOISE_TVH] = 1;
}

static Status read_row(SensorPreset *out, const TableRows *rows, int number)
{
    Row          row = {.p = {.noise_scale = 1, .smear = true}};
    const Status status = table_rows_get(&row, rows, number);
    if (status != STATUS_OK) return status;
    SensorPreset *p = &row.p;
    snprintf(p->name, sizeof p->name, "%s", row.name);
    p->channel = channel_named(row.band, strlen(row.band));
    if (p->channel ? p->channel->place < (p->channel->standard ? SPECTRAL_MWIR : SPECTRAL_NIR)
                   : strcmp(row.band, "optical") != 0)
        return table_rows_refuse(rows, number, "band",
                                 "one of optical, mwir, lwir, or another channel of etc/channels.csv");
    p->band = !p->channel || p->channel->place == SPECTRAL_NIR ? BAND_OPTICAL
              : p->channel->place == SPECTRAL_MWIR             ? BAND_MWIR
                                                               : BAND_LWIR;
    p->auto_exposure = row.exposure == 1;
    p->scan.bidirectional = row.scan == 2;
    p->scan.by_columns = row.scan == 3;
    preset_refresh(p);
    *out = *p;
    return STATUS_OK;
}

Status preset_read(SensorPreset *out, const char *path, const char *name)
{
    TableRows rows;
    char      before[600] = "";
    int       row;
    Status    status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    if (etc_own("sensors.csv")) snprintf(before, sizeof before, " (nor in %s)", etc_own("sensors.csv"));
    status = table_rows_find(&row, &rows, name, "sensor", before, "");
    if (status == STATUS_OK) status = read_row(out, &rows, row);
    table_rows_close(&rows);
    return status;
}

Status preset_has(bool *has, const char *path, const char *name)
{
    TableRows    rows;
    const Status status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    *has = false;
    for (int i = 0; i < rows.table.rows; i++) *has |= strcmp(table_rows_text(&rows, i, "name"), name) == 0;
    table_rows_close(&rows);
    return STATUS_OK;
}

Status preset_check(const char *path)
{
    TableRows    rows;
    SensorPreset p;
    Status       status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < rows.table.rows && status == STATUS_OK; i++) status = read_row(&p, &rows, i);
    table_rows_close(&rows);
    return status;
}
