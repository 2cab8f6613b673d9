/// A cube of the C library, shared by all surfaces that name its file.

#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>

#include <upglow.h>

namespace upglow_mitsuba {

/// Throws what the library says of a call that failed, in its own words.
inline void expect_ok(UpglowStatus status) {
    if (status != UPGLOW_STATUS_OK)
        throw std::runtime_error(std::string("upglow: ") + upglow_message());
}

/// Materials for all colors of an RGB space. It never changes; threads may share it.
class Cube {
public:
    /// The cube in a file. It is read once for as long as anybody holds it.
    ///
    /// Throws std::runtime_error if the file cannot be read or is no cube.
    static std::shared_ptr<const Cube> load(const std::string &path);

    ~Cube() { upglow_cube_destroy(m_cube); }
    Cube(const Cube &) = delete;
    Cube &operator=(const Cube &) = delete;

    /// The material of a color: linear, in the cube's RGB space, 0 to 1. It refers to this cube.
    ///
    /// Throws std::runtime_error if a component is outside.
    UpglowMaterial look_up(const std::array<float, 3> &rgb) const;

    /// Nodes along each axis.
    uint32_t resolution() const { return m_facts.resolution; }

    /// Name of the RGB space.
    const char *rgb_space() const { return m_facts.rgb_space; }

    /// The file it came from.
    const std::string &path() const { return m_path; }

private:
    explicit Cube(const std::string &path);

    std::string m_path;
    UpglowCube *m_cube = nullptr;
    UpglowCubeFacts m_facts{};
};

/// Share of light at a wavelength that a material reflects, 0 to 1. The material was looked up.
float reflectance_of(const UpglowMaterial &material, float lambda_nm);

}  // namespace upglow_mitsuba
