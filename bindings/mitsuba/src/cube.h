/// A cube of the C library, shared by all surfaces that name its file.

#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

#include <upglow.h>

namespace upglow_mitsuba {

/// Throws the library's message if a call failed.
inline void expect_ok(UpglowStatus status) {
    if (status != UPGLOW_STATUS_OK)
        throw std::runtime_error(std::string("upglow: ") + upglow_message());
}

/// Materials for all colors of an RGB space. It is immutable; threads may share it.
class Cube {
public:
    /// The cube in a file. Surfaces that use it at the same time share one copy.
    ///
    /// Throws std::runtime_error if the file cannot be read or is not a cube.
    static std::shared_ptr<const Cube> load(const std::string &path) {
        static std::mutex mutex;
        static std::map<std::string, std::weak_ptr<const Cube>> loaded;
        std::lock_guard<std::mutex> guard(mutex);
        std::weak_ptr<const Cube> &entry = loaded[path];
        if (std::shared_ptr<const Cube> cube = entry.lock())
            return cube;
        std::shared_ptr<const Cube> cube(new Cube(path));
        entry = cube;
        return cube;
    }

    ~Cube() { upglow_cube_destroy(m_cube); }
    Cube(const Cube &) = delete;
    Cube &operator=(const Cube &) = delete;

    /// The material of a color: linear, in the cube's RGB space, 0 to 1. It refers to this cube.
    ///
    /// Throws std::runtime_error if a component is outside.
    UpglowMaterial look_up(const std::array<float, 3> &rgb) const {
        UpglowMaterial material;
        expect_ok(upglow_look_up(m_cube, rgb.data(), &material));
        return material;
    }

    /// Nodes along each axis.
    uint32_t resolution() const { return m_facts.resolution; }

    /// Name of the RGB space.
    const char *rgb_space() const { return m_facts.rgb_space; }

    /// The file it came from.
    const std::string &path() const { return m_path; }

private:
    explicit Cube(const std::string &path) : m_path(path) {
        expect_ok(upglow_cube_open(path.c_str(), &m_cube));
        expect_ok(upglow_cube_facts(m_cube, &m_facts));
    }

    std::string m_path;
    UpglowCube *m_cube = nullptr;
    UpglowCubeFacts m_facts{};
};

}  // namespace upglow_mitsuba
