/* sensor/detector/preset.c: reads rows of etc/sensors.csv. */
#include "sensor/detector/preset.h"

#include "render/air/atmosphere.h"

typedef struct Column {
    const char *name;
    size_t      offset;
    double      low, high, unit; /* of the file; unit: factor to the field's */
} Column;

#define FIELD(member) offsetof(SensorPreset, member)

static const Column columns[] = {
    {"width_px", FIELD(width_px), 8, 8192, 1},
    {"height_px", FIELD(height_px), 8, 8192, 1},
    {"hfov_deg", FIELD(hfov_deg), 0.01, 120, 1},
    {"f_number", FIELD(photons.f_number), 0.5, 100, 1},
    {"obscuration", FIELD(obscuration), 0, 0.95, 1},
    {"pitch_um", FIELD(photons.pitch_m), 0.5, 1000, 1e-6},
    {"footprint", FIELD(footprint), 0.1, 1, 1},
    {"transmission", FIELD(photons.transmission), 0.001, 1, 1},
    {"qe", FIELD(photons.qe), 0.001, 1, 1},
    {"integration_ms", FIELD(photons.integration_s), 1e-6, 1e4, 1e-3},
    {"dark_e_s", FIELD(dark_e_s), 0, 1e15, 1},
    {"read_e", FIELD(photons.read_e), 0, 1e9, 1},
    {"well_e", FIELD(photons.well_e), 100, 1e12, 1},
    {"bits", FIELD(bits), 8, 16, 1},
    {"jitter_px", FIELD(jitter_px), 0, 10, 1},
    {"tv", FIELD(ratio.sigma[NOISE_TV]), 0, 100, 1},
    {"th", FIELD(ratio.sigma[NOISE_TH]), 0, 100, 1},
    {"vh", FIELD(ratio.sigma[NOISE_VH]), 0, 100, 1},
    {"t", FIELD(ratio.sigma[NOISE_T]), 0, 100, 1},
    {"v", FIELD(ratio.sigma[NOISE_V]), 0, 100, 1},
    {"h", FIELD(ratio.sigma[NOISE_H]), 0, 100, 1},
    {"prnu", FIELD(prnu), 0, 0.5, 1},
    {"line_us", FIELD(scan.line_s), 0, 1e6, 1e-6},
    {"active", FIELD(scan.active), 0, 1, 1},
    {"ac_per_line", FIELD(ac_per_line), 0, 100, 1},
    {"line_noise", FIELD(line_noise), 0, 100, 1},
    {"line_noise_px", FIELD(line_noise_px), 0, 1e4, 1},
    {"bad_share", FIELD(bad_share), 0, 0.2, 1},
    {"bad_clustered", FIELD(bad_clustered), 0, 1, 1},
    {"bad_patched", FIELD(bad_patched), 0, 1, 1},
    {"tdi", FIELD(tdi), 1, 1000, 1},
    {"k1", FIELD(lens[0]), -1e6, 1e6, 1},
    {"k2", FIELD(lens[1]), -1e9, 1e9, 1},
    {"k3", FIELD(lens[2]), -1e12, 1e12, 1},
    {"p1", FIELD(lens[3]), -1e3, 1e3, 1},
    {"p2", FIELD(lens[4]), -1e3, 1e3, 1},
    {"lateral_r", FIELD(lateral[0]), -0.02, 0.02, 1},
    {"lateral_b", FIELD(lateral[1]), -0.02, 0.02, 1},
};
enum { column_count = sizeof columns / sizeof columns[0] };

void preset_band(double *low_m, double *high_m, Band band, OpticalChannels optical, int channel)
{
    static const AirBand rgb[3] = {AIR_R, AIR_G, AIR_B};
    *low_m = *high_m = NAN;
    if (band == BAND_RADAR) return;
    AirBand air = band == BAND_MWIR ? AIR_MWIR : band == BAND_LWIR ? AIR_LWIR : AIR_PAN;
    if (band == BAND_OPTICAL && optical == OPTICAL_NIR) air = AIR_NIR;
    if (band == BAND_OPTICAL && optical == OPTICAL_RGB && channel >= 0) air = rgb[channel];
    air_band_edges(low_m, high_m, air);
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
    preset_band(&p->photons.low_m, &p->photons.high_m, p->band, p->optical, -1);
    p->photons.dark_e = p->dark_e_s * p->photons.integration_s;
    p->ratio.sigma[NOISE_TVH] = 1;
}

static Status bad_word(const Table *t, int row, const char *column, const char *value, const char *words)
{
    log_error("sensors: %s:%d: %s: '%s' is not one of %s", t->path, t->line[row + 1], column, value, words);
    return STATUS_BAD_VALUE;
}

/* A required column. */
static int need(const Table *t, const char *name)
{
    const int column = table_column(t, name);
    if (column < 0) log_error("sensors: %s: no column %s", t->path, name);
    return column;
}

static Status read_row(SensorPreset *out, const Table *t, int row)
{
    SensorPreset p = {.noise_scale = 1, .smear = true};
    const int    band = need(t, "band"), exposure = need(t, "exposure"), scan = need(t, "scan");
    if (band < 0 || exposure < 0 || scan < 0) return STATUS_BAD_VALUE;
    snprintf(p.name, sizeof p.name, "%s", table_text(t, row, table_column(t, "name")));

    const char *text = table_text(t, row, band);
    p.channel = channel_named(text, strlen(text));
    if (p.channel ? p.channel->place < (p.channel->standard ? SPECTRAL_MWIR : SPECTRAL_NIR)
                  : strcmp(text, "optical") != 0)
        return bad_word(t, row, "band", text, "optical, mwir, lwir, or another channel of etc/channels.csv");
    p.band = !p.channel || p.channel->place == SPECTRAL_NIR ? BAND_OPTICAL
             : p.channel->place == SPECTRAL_MWIR            ? BAND_MWIR
                                                            : BAND_LWIR;
    text = table_text(t, row, exposure);
    if (strcmp(text, "fixed") != 0 && strcmp(text, "auto") != 0)
        return bad_word(t, row, "exposure", text, "fixed, auto");
    p.auto_exposure = text[0] == 'a';
    text = table_text(t, row, scan);
    if (strcmp(text, "stare") != 0 && strcmp(text, "lines") != 0 && strcmp(text, "both") != 0 &&
        strcmp(text, "columns") != 0)
        return bad_word(t, row, "scan", text, "stare, lines, both, columns");
    p.scan.bidirectional = text[0] == 'b';
    p.scan.by_columns = text[0] == 'c';

    for (int i = 0; i < column_count; i++) {
        double    value;
        const int column = need(t, columns[i].name);
        if (column < 0) return STATUS_BAD_VALUE;
        const Status status = table_number(&value, t, row, column, columns[i].low, columns[i].high);
        if (status != STATUS_OK) return status;
        value *= columns[i].unit;
        memcpy((char *)&p + columns[i].offset, &value, sizeof value);
    }
    if (floor(p.bits) != p.bits || floor(p.width_px) != p.width_px || floor(p.height_px) != p.height_px ||
        floor(p.tdi) != p.tdi) {
        log_error("sensors: %s:%d: bits=%g, width_px=%g, height_px=%g and tdi=%g must be whole numbers", t->path,
                  t->line[row + 1], p.bits, p.width_px, p.height_px, p.tdi);
        return STATUS_BAD_VALUE;
    }
    preset_refresh(&p);
    *out = p;
    return STATUS_OK;
}

Status preset_read(SensorPreset *out, const char *path, const char *name)
{
    Table  table;
    char   known[512] = "", before[600] = "";
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    const int column = need(&table, "name");
    int       row = -1;
    WordMeant meant = word_meant(name);
    status = STATUS_BAD_VALUE;
    for (int i = 0; column >= 0 && i < table.rows; i++) {
        const char  *here = table_text(&table, i, column);
        const size_t length = strlen(known);
        if (strcmp(here, name) == 0 && row < 0) row = i;
        snprintf(known + length, sizeof known - length, "%s%s", i ? ", " : "", here);
        word_consider(&meant, here);
    }
    if (row < 0 && etc_own("sensors.csv")) snprintf(before, sizeof before, " (nor in %s)", etc_own("sensors.csv"));
    if (row >= 0) status = read_row(out, &table, row);
    else if (column >= 0)
        log_error("sensors: %s: no sensor named '%s'%s; there are: %s%s", path, name, before, known, word_hint(&meant));
    table_close(&table);
    return status;
}

Status preset_has(bool *has, const char *path, const char *name)
{
    Table  table;
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    const int column = need(&table, "name");
    *has = false;
    for (int i = 0; column >= 0 && i < table.rows; i++) *has |= strcmp(table_text(&table, i, column), name) == 0;
    table_close(&table);
    return column >= 0 ? STATUS_OK : STATUS_BAD_VALUE;
}

Status preset_check(const char *path)
{
    Table        table;
    SensorPreset p;
    Status       status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    if (need(&table, "name") < 0) status = STATUS_BAD_VALUE;
    for (int i = 0; i < table.rows && status == STATUS_OK; i++) status = read_row(&p, &table, i);
    table_close(&table);
    return status;
}
