/* render/heat/part_table.h: what the parts of models are made of and what is behind them: etc/heat.csv and
 * etc/heat_machines.csv, which give units and sources. */
#ifndef RENDER_HEAT_PART_TABLE_H
#define RENDER_HEAT_PART_TABLE_H

#include "entities/models/model.h"

typedef enum PartInside {
    INSIDE_NONE = 0,
    INSIDE_ENGINE,
    INSIDE_CABIN,
    INSIDE_EXHAUST,
    INSIDE_TURBINE,
    INSIDE_MOTOR,
    INSIDE_BODY,
    INSIDE_ROOM,
    INSIDE_FLUE,
    INSIDE_GRAIN,
    INSIDE_FIRE,
    INSIDE_EMBER,
    INSIDE_SMOULDER,
    INSIDE_COUNT
} PartInside;

typedef enum PartDrive { PART_DRIVE_NONE = 0, PART_DRIVE_MOTION, PART_DRIVE_FIRING, PART_DRIVE_COUNT } PartDrive;

typedef struct PartRow {
    double     thickness_m;
    PartInside inside;
    double     inside_w_m2k, running_w_m2k;
    PartDrive  drive;
    double     drive_value; /* W/m2 at 10 m/s; J a kg of propellant */
} PartRow;

typedef struct MachineRow {
    char   model[model_name_size];
    double engine_w, engine_j_k, engine_k, exhaust_k, cabin_j_k, cabin_w, fuel_j_k,
        fuel_w_k; /* fuel_j_k 0: no node of it */
} MachineRow;

enum { part_table_most = 64 };

typedef struct PartTable {
    PartRow    role[HEAT_ROLE_COUNT];
    int        machines; /* the last: of a cubic metre, of all others */
    MachineRow machine[part_table_most];
} PartTable;

/* Every role must have its row, and there must be a last row `*`. Failures are logged with file and line. */
Status part_table_open(PartTable *out, const char *parts_path, const char *machines_path);
/* One of the two files. */
Status part_table_roles(PartTable *out, const char *path);
Status part_table_machines(PartTable *out, const char *path);
/* Of a model, by its name, or scaled by the volume of its box. */
MachineRow part_table_machine(const PartTable *table, const Model *model);

#endif
