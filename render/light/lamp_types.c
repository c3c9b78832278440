/* render/light/lamp_types.c: reads etc/lamps.csv. */
#include "render/light/lamps.h"

#include "pitviper_table.h"

#include <stdio.h>

enum { fixed_count = 6, reflective = optical_channel_count };

static const struct {
    ChannelPlace place;
    int          channel;
} places[] = {{SPECTRAL_B, optical_channel_b},
              {SPECTRAL_G, optical_channel_g},
              {SPECTRAL_R, optical_channel_r},
              {SPECTRAL_NIR, optical_channel_nir}};
enum { place_count = sizeof places / sizeof *places };

static Status take(void *user, const void *read, const TableRows *rows, int number)
{
    LampTypes *types = user;
    LampType   t = *(const LampType *)read;
    if (t.where == LAMP_WINDOW ? t.flux_lm > 0 : t.luminance_cd_m2 > 0)
        return table_rows_refuse(rows, number, t.where == LAMP_WINDOW ? "flux_lm" : "luminance_cd_m2",
                                 "0: a window has a luminance, other lamps have a flux");
    if (t.where != LAMP_VEHICLE && t.beam_rad > 0)
        return table_rows_refuse(rows, number, "beam_deg", "0: only headlamps have a beam");
    if (t.where == LAMP_VEHICLE && !(t.beam_rad > 0))
        return table_rows_refuse(rows, number, "beam_deg", "more than 0 of headlamps");
    t.w_lm[optical_channel_pan] = t.w_lm[optical_channel_b] + t.w_lm[optical_channel_g] + t.w_lm[optical_channel_r];
    types->type[types->count++] = t;
    return STATUS_OK;
}

Status lamp_types_read(LampTypes *out, const char *path)
{
    TableColumn column[fixed_count + place_count] = {
        {"name", .type = TABLE_NAME, TABLE_AT(LampType, name)},
        {"where", TABLE_CHOICE, TABLE_AT(LampType, where), .choices = "window, street, vehicle"},
        {"share", TABLE_DOUBLE, TABLE_AT(LampType, share), .low = 0, .high = 1},
        {"flux_lm", TABLE_DOUBLE, TABLE_AT(LampType, flux_lm), .low = 0, .high = 1e6},
        {"luminance_cd_m2", TABLE_DOUBLE, TABLE_AT(LampType, luminance_cd_m2), .low = 0, .high = 1e5},
        {"beam_deg", TABLE_DOUBLE, TABLE_AT(LampType, beam_rad), .low = 0, .high = 60, .unit = pi_rad / 180},
    };
    char   name[place_count][32];
    Status status = channels_load();
    if (status != STATUS_OK) return status;
    for (int k = 0; k < place_count; k++) {
        snprintf(name[k], sizeof name[k], "w_lm_%s", channel_in(places[k].place)->name);
        column[fixed_count + k] =
            (TableColumn){.name = name[k],
                          .type = TABLE_DOUBLE,
                          .offset = offsetof(LampType, w_lm) + (size_t)places[k].channel * sizeof(double),
                          .size = sizeof(double),
                          .high = 1,
                          .absent = TABLE_LATER};
    }
    const TableFormat format = {.module = "lamps",
                                .column = column,
                                .count = fixed_count + place_count,
                                .next = "etc/lamps.csv explains the columns",
                                .most_rows = lamp_types_most};
    LampType          row;
    out->count = 0;
    return table_each(&format, path, &row, sizeof row, take, out);
}

const LampType *lamp_type_of(const LampTypes *types, const SceneryLamp *lamp)
{
    const LampType *last = NULL;
    double          all = 0, below = 0;
    for (int k = 0; k < types->count; k++)
        if ((int)types->type[k].where == lamp->kind) all += types->type[k].share;
    for (int k = 0; k < types->count; k++) {
        if ((int)types->type[k].where != lamp->kind || !(types->type[k].share > 0)) continue;
        last = &types->type[k];
        below += last->share;
        if ((double)lamp->type * all < below) break;
    }
    return last;
}
