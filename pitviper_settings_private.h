/* pitviper_settings_private.h: what the files of settings share. */
#ifndef PITVIPER_SETTINGS_PRIVATE_H
#define PITVIPER_SETTINGS_PRIVATE_H

#include "pitviper_settings.h"

/* A value within its row's range. */
bool settings_number(double *out, const Setting *row, const char *value);
/* One value into its place. file: paths are relative to its folder; NULL: to the current one. */
Status settings_store(void *out, const SettingTable *table, const Setting *row, const char *value, const char *source,
                      const char *file);
/* Logged with the key that was perhaps meant. */
Status settings_say_unknown(const SettingTable *table, const char *source, const char *name);
/* What a row accepts, in words: `a number in 0 .. 10 m`. */
void        settings_accepted(char *out, size_t out_size, const Setting *row);
const char *settings_prefix(const SettingTable *table); /* of its keys in messages */

#endif
