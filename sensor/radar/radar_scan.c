/* sensor/radar/radar_scan.c: the positions of a scan. */
#include "sensor/radar/radar_scan.h"

Status scan_plan(ScanPlan *out, const RadarPreset *preset, double sector_rad, double step_share)
{
    const Waveform *wave = &preset->wave;
    *out = (ScanPlan){.positions = 1, .interval_s = wave->pulses / wave->repeat_hz};
    if (!(sector_rad > 0)) return STATUS_OK;
    out->step_rad = step_share * antenna_width_rad(&preset->antenna);
    const double side = ceil(0.5 * sector_rad / out->step_rad - 1e-9), all = 2 * side + 1;
    if (all > scan_positions_most || all * wave->pulses * wave->samples > 1 << 27) {
        log_error("radar: a scan of %.1f degrees is %.0f positions of %s; choose a smaller radar.scan_deg or a larger "
                  "radar.scan_step (at most %d positions, 2^27 samples in all)",
                  sector_rad / rad_per_deg, all, preset->name, scan_positions_most);
        return STATUS_BAD_VALUE;
    }
    out->positions = (int)all;
    return STATUS_OK;
}
