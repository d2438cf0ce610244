#include "preprocess/report_page.h"

#include <fmt/format.h>

#include <algorithm>

namespace glowworm {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 62em; padding: 0 1em;
       color: #222; background: #fff }
h1 { font-size: 1.5em; margin: 0 } h2 { font-size: 1.1em; margin: 2em 0 .5em }
table { border-collapse: collapse; font-variant-numeric: tabular-nums }
td, th { padding: .2em .9em .2em 0; text-align: right; border-bottom: 1px solid #ddd }
td:first-child, th:first-child { text-align: left }
pre { overflow-x: auto; background: #f5f5f2; padding: .8em; font-size: 12.5px; line-height: 1.35 }
img { max-width: 100%; display: block; background: #111 }
li.warning { color: #8a4b00 } .good { color: #1b6e2c } .bad { color: #a02020 }
.verdict { font-size: 1.15em; font-weight: 600; margin: .6em 0 } .small { color: #666; margin: 0 }
.bar { background: #5a87b8; height: .8em; display: inline-block }
)";

constexpr const char* kTrustKey = R"(<p class="small">Overlap: the share of a scan that others saw
too. Rmse: how far it lies from their surfaces there. Loop: by how much the way round through other
scans misses. Weak axes: what nothing in the scan holds. Through: the share that the other scan looked
through, near 0 where a pair is right.</p>
)";

std::string escaped(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            default:
                safe += c;
        }
    }
    return safe;
}

std::string table(const Rows& rows, bool has_head) {
    std::string html = "<table>\n";
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const char* cell = has_head && i == 0 ? "th" : "td";
        html += "<tr>";
        for (const std::string& text : rows[i])
            html += fmt::format("<{}>{}</{}>", cell, escaped(text), cell);
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

std::string picture(const std::string& png, const std::string& what) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(png.data(), png.size()));
    return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", what, base64(bytes));
}

/// The sentences that a hurried reader reads.
std::string verdict(const RunPage& page) {
    const bool no_octree = page.levels.empty();
    std::string html =
        no_octree ? fmt::format("<p class=\"verdict bad\">{}</p>\n", escaped(page.no_frame))
        : page.doubt.empty() ? "<p class=\"verdict good\">Every scan is placed and held.</p>\n"
                             : fmt::format("<p class=\"verdict bad\">Look at the poses: {}.</p>\n",
                                           escaped(page.doubt));
    if (!page.warnings.empty()) {
        html += fmt::format("<p class=\"verdict\"><a href=\"#warnings\">{} warning{}</a></p>\n",
                            page.warnings.size(), page.warnings.size() == 1 ? "" : "s");
    }
    return html;
}

std::string warning_list(const std::vector<Warning>& warnings) {
    if (warnings.empty()) return "<p class=\"good\">None.</p>\n";
    std::string html = "<ul>\n";
    for (const Warning& warning : warnings) {
        html += fmt::format("<li class=\"warning\"><b>{}</b>: {} [{}]</li>\n",
                            escaped(warning.file), escaped(warning.sentence), escaped(warning.id));
    }
    return html + "</ul>\n";
}

std::string time_table(const std::vector<PhaseTime>& timings) {
    double total = 0.0;
    for (const PhaseTime& phase : timings)
        total += phase.seconds;
    std::string html = "<table>\n<tr><th>stage</th><th>s</th><th>share</th><th></th></tr>\n";
    for (const PhaseTime& phase : timings) {
        const double share = total > 0.0 ? 100.0 * phase.seconds / total : 0.0;
        html += fmt::format(
            "<tr><td>{}</td><td>{:.2f}</td><td>{:.0f} %</td><td style=\"text-align:left\">"
            "<span class=\"bar\" style=\"width:{:.1f}em\"></span></td></tr>\n",
            escaped(phase.name), phase.seconds, share, share * 0.2);
    }
    return html +
           fmt::format("<tr><td>all</td><td>{:.2f}</td><td></td><td></td></tr>\n</table>\n", total);
}

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t given = std::min<std::size_t>(3, bytes.size() - i);
        unsigned value = 0;
        for (std::size_t j = 0; j < 3; ++j)
            value = value << 8 | (j < given ? std::to_integer<unsigned>(bytes[i + j]) : 0u);
        for (std::size_t j = 0; j < 4; ++j)
            text += j <= given ? kDigits[value >> (18 - 6 * j) & 63] : '=';
    }
    return text;
}

std::string format_page(const RunPage& page) {
    std::string html = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n";
    html += fmt::format(
        "<title>{}</title>\n<style>{}</style>\n<h1>{}</h1>\n<p class=\"small\">{}</p>\n",
        escaped(page.title), kStyle, escaped(page.title), escaped(page.made));
    html += verdict(page);
    html += table(page.facts, false);
    if (!page.frame_png.empty()) {
        html +=
            "<h2>First frame</h2>\n" + picture(page.frame_png, "the cave from its first station");
    } else if (!page.levels.empty()) {
        html += fmt::format("<h2>First frame</h2>\n<p>{}</p>\n", escaped(page.no_frame));
    }
    if (!page.plan_png.empty()) {
        html += "<h2>From above</h2>\n<p>A colour for each scan, stations as ringed discs.</p>\n" +
                picture(page.plan_png, "plan view of the placed scans");
    }
    html += "<h2 id=\"warnings\">Warnings</h2>\n" + warning_list(page.warnings);
    html += "<h2>How far each scan is trusted</h2>\n<pre>" + escaped(page.trust) + "</pre>\n";
    html += kTrustKey;
    if (!page.levels.empty()) html += "<h2>Octree, per level</h2>\n" + table(page.levels, true);
    html += "<h2>Time of this run</h2>\n" + time_table(page.timings);
    return html;
}

}  // namespace glowworm
