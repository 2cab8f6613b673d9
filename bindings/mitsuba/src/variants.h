/// Registration of plugins in the variants of Mitsuba that they support, and a message in the others.

#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <mitsuba/core/object.h>
#include <mitsuba/core/properties.h>

#if defined(__x86_64__) && !defined(__AVX2__)
#  error "compile with -march=haswell: Mitsuba's wheel passes packets of numbers in AVX registers"
#endif

namespace upglow_mitsuba {

/// A variant that a plugin supports, and the function that makes the plugin there.
struct Variant {
    std::string_view name;
    mitsuba::PluginInstantiateFn instantiate;
};

/// Number of variants that Mitsuba was built with.
constexpr size_t variant_count() {
    size_t count = 0;
    for (char letter : std::string_view(MI_VARIANTS))
        count += letter == '\n';
    return count;
}

/// Name of the variant at `index` in Mitsuba's list.
constexpr std::string_view variant_name(size_t index) {
    std::string_view list(MI_VARIANTS);
    for (; index > 0; --index)
        list.remove_prefix(list.find('\n') + 1);
    return list.substr(0, list.find('\n'));
}

template <typename Plugin>
mitsuba::ref<mitsuba::Object> instantiate(void *, const mitsuba::Properties &props) {
    return new Plugin(props);
}

/// Throws the message of a variant that a plugin does not support. `Expected::text` names the others.
template <typename Expected, size_t Index>
mitsuba::ref<mitsuba::Object> refuse(void *, const mitsuba::Properties &) {
    throw std::runtime_error("the native plugin does not work in the variant " +
                             std::string(variant_name(Index)) + ", expected " + Expected::text);
}

/// Registers a plugin in the variants that it supports, and `refuse` in the others.
template <typename Expected, size_t Count, size_t... Index>
void enter(std::string_view name, mitsuba::PluginRegisterFn plugin, mitsuba::ObjectType type,
           const Variant (&works)[Count], std::index_sequence<Index...>) {
    (plugin(name, variant_name(Index), type, refuse<Expected, Index>), ...);
    for (const Variant &variant : works)
        plugin(name, variant.name, type, variant.instantiate);
}

}  // namespace upglow_mitsuba
