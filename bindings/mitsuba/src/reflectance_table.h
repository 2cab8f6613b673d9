/// Tables of reflectances for traced code, which cannot call functions of the library.

#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <drjit/array.h>
#include <drjit/jit.h>
#include <mitsuba/core/fwd.h>

#include "cube.h"

namespace upglow_mitsuba {

/// First and last wavelength of a row, nm: the range of a cube's curves, which contains that of
/// Mitsuba's sensors. Wavelengths outside are clamped.
constexpr uint32_t FIRST_NM = 300, LAST_NM = 830;

/// Samples of a row, 1 nm apart as in the curves of dyes: the error of linear interpolation is then at
/// most 2e-4. With steps of 2 nm it is 7e-3 at the ends of these curves.
constexpr uint32_t SAMPLES = LAST_NM - FIRST_NM + 1;

/// The integer for a reflectance of 1. Two samples of 16 bits share a word: 35 MB for 32 nodes along
/// each axis, with an error of at most 8e-6.
constexpr uint32_t ONE = 0xffff;

/// Words of a row.
constexpr uint32_t ROW_WORDS = (SAMPLES + 1) / 2;

/// Rows of reflectances, `[row][wavelength]`.
template <typename Float, typename Spectrum> class ReflectanceTable {
public:
    using UInt32     = drjit::uint32_array_t<Float>;
    using Mask       = drjit::mask_t<Float>;
    using Color      = mitsuba::Color<Float, 3>;
    using Wavelength = mitsuba::wavelength_t<Spectrum>;

    /// The one row of a material.
    static ReflectanceTable of_material(const UpglowMaterial &material) {
        std::vector<uint32_t> words;
        append_row(material, words);
        return ReflectanceTable(1, words);
    }

    /// A row for each node of a cube, `[blue][green][red]`.
    static ReflectanceTable of_nodes(const Cube &cube) {
        uint32_t n = cube.resolution();
        std::vector<uint32_t> words;
        words.reserve(size_t(n) * n * n * ROW_WORDS);
        for (uint32_t node = 0; node < n * n * n; ++node)
            append_row(cube.look_up(node_color(node, n)), words);
        return ReflectanceTable(n, words);
    }

    /// Reflectance of the one row.
    Spectrum at(const Wavelength &lambda_nm, const Mask &active) const {
        return row(drjit::zeros<UInt32>(), lambda_nm, active);
    }

    /// Reflectance of a color with components in 0 to 1: the blend of the four nodes around it, as
    /// docs/cube-format.md defines it.
    Spectrum at(const Color &rgb, const Wavelength &lambda_nm, const Mask &active) const {
        Color scaled   = rgb * float(m_nodes - 1);
        Color low      = drjit::minimum(drjit::floor(scaled), float(m_nodes - 2));
        Color fraction = scaled - low;
        Float greatest = drjit::max(fraction), least = drjit::min(fraction);
        Float middle   = drjit::sum(fraction) - greatest - least;
        UInt32 dark    = node(low), bright = dark + 1 + m_nodes + m_nodes * m_nodes;
        UInt32 second  = dark + first_step(fraction), third = bright - last_step(fraction);
        return row(dark, lambda_nm, active) * (1.f - greatest) +
               row(second, lambda_nm, active) * (greatest - middle) +
               row(third, lambda_nm, active) * (middle - least) +
               row(bright, lambda_nm, active) * least;
    }

    /// The array that look-ups read.
    const UInt32 &words() const { return m_words; }

private:
    ReflectanceTable(uint32_t nodes, const std::vector<uint32_t> &words)
        : m_nodes(nodes), m_words(drjit::load<UInt32>(words.data(), words.size())) {}

    static std::array<float, 3> node_color(uint32_t node, uint32_t n) {
        float last = float(n - 1);
        return { float(node % n) / last, float(node / n % n) / last, float(node / n / n) / last };
    }

    static void append_row(const UpglowMaterial &material, std::vector<uint32_t> &words) {
        for (uint32_t i = 0; i < SAMPLES; i += 2)
            words.push_back(sample(material, i) | sample(material, i + 1) << 16);
    }

    static uint32_t sample(const UpglowMaterial &material, uint32_t i) {
        float reflectance;
        expect_ok(upglow_reflectance(&material, float(FIRST_NM + i), &reflectance));
        return uint32_t(reflectance * float(ONE) + 0.5f);
    }

    UInt32 node(const Color &low) const {
        return UInt32(low[0]) + m_nodes * (UInt32(low[1]) + m_nodes * UInt32(low[2]));
    }

    /// The step along the axis of the greatest fraction. The choice between equal fractions does not
    /// matter: the node that depends on it has the weight 0.
    UInt32 first_step(const Color &f) const {
        UInt32 red_or_green = drjit::select(f[0] >= f[1], UInt32(1), UInt32(m_nodes));
        return drjit::select(drjit::maximum(f[0], f[1]) >= f[2], red_or_green,
                             UInt32(m_nodes * m_nodes));
    }

    /// The step along the axis of the least fraction; equal ones do not matter for the same reason.
    UInt32 last_step(const Color &f) const {
        UInt32 green_or_red = drjit::select(f[1] <= f[0], UInt32(m_nodes), UInt32(1));
        return drjit::select(f[2] <= drjit::minimum(f[0], f[1]), UInt32(m_nodes * m_nodes),
                             green_or_red);
    }

    Spectrum row(const UInt32 &index, const Wavelength &lambda_nm, const Mask &active) const {
        Spectrum reflectance;
        for (size_t i = 0; i < Spectrum::Size; ++i) {
            Float place = drjit::clip(lambda_nm[i], float(FIRST_NM), float(LAST_NM)) - float(FIRST_NM);
            UInt32 left = drjit::minimum(UInt32(place), SAMPLES - 2);
            Float from = value(index, left, active), to = value(index, left + 1, active);
            reflectance[i] = drjit::lerp(from, to, place - Float(left));
        }
        return reflectance;
    }

    Float value(const UInt32 &index, const UInt32 &sample, const Mask &active) const {
        UInt32 word = drjit::gather<UInt32>(m_words, index * ROW_WORDS + (sample >> 1), active);
        return Float((word >> ((sample & 1u) << 4)) & ONE) / float(ONE);
    }

    uint32_t m_nodes;
    UInt32 m_words;
};

/// The table of a cube's nodes. Surfaces that use it at the same time share one copy.
template <typename Float, typename Spectrum>
std::shared_ptr<const ReflectanceTable<Float, Spectrum>>
shared_node_table(const std::shared_ptr<const Cube> &cube) {
    using Table = ReflectanceTable<Float, Spectrum>;
    static std::mutex mutex;
    static std::map<std::weak_ptr<const Cube>, std::weak_ptr<const Table>, std::owner_less<>> made;
    std::lock_guard<std::mutex> guard(mutex);
    std::weak_ptr<const Table> &entry = made[cube];
    if (std::shared_ptr<const Table> table = entry.lock())
        return table;
    auto table = std::make_shared<const Table>(Table::of_nodes(*cube));
    entry      = table;
    return table;
}

}  // namespace upglow_mitsuba
