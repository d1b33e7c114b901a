// solve_light() around its kernels: the host lays out what blocks the view and chooses senders,
// kernels find out who sees whom, and reflections are products of matrices. CUDA launches the
// kernels; tests run them in loops.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <ATen/core/Tensor.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/mm.h>
#include <ATen/ops/tensor.h>
#include <ATen/ops/zeros.h>
#include <ATen/ops/zeros_like.h>

#include "lte/ops/solve_light.h"
#include "lte/ops/solve_light_args.h"
#include "lte/ops/solve_light_kernel.h"
#include "lte/radiosity/layout.h"

namespace lte::ops {

/// What solve_light() is given.
struct SurfaceTensors {
  at::Tensor position, normal, albedo, emission, area;
};

/// @tparam Kernels  with `direct(view, rows [D], light [D, 6])`, which fills light by direct_at(),
///                  and `links(view, rows [R], senders [S], areas [S], links [R, 2, 2 S])`, which
///                  writes what link_of() says to [row, side it reaches, side it leaves · S +
///                  sender], of zeros
template <typename Kernels>
class LightTwin {
 public:
  LightTwin(const at::Tensor& position, const at::Tensor& normal, const at::Tensor& albedo,
            const at::Tensor& emission, const at::Tensor& area, const Kernels& kernels)
      : device_(position.device()),
        position_(position),
        normal_(normal),
        albedo_(albedo),
        emission_(emission),
        area_(area),
        host_{position.cpu(), normal.cpu(), albedo.cpu(), emission.cpu(), area.cpu()},
        layout_(host_points()),
        kernels_(kernels) {}

  at::Tensor run() {
    lay_out();
    const at::Tensor dark = rows_of(layout_.dark());
    at::Tensor direct = at::empty({dark.size(0), 6}, position_.options());
    if (dark.size(0) > 0) kernels_.direct(view_, dark, direct);
    choose_senders(direct);
    const at::Tensor radiosity = bounce(direct);
    std::vector<at::Tensor> indirect = {at::empty({0, 2, 3}, position_.options())};
    for (int64_t first = 0; first < dark.size(0); first += kBlock) {
      const int64_t count = std::min(kBlock, dark.size(0) - first);
      indirect.push_back(received(dark.narrow(0, first, count), radiosity));
    }
    const at::Tensor sides = direct.view({-1, 2, 3}), bounced = at::cat(indirect);
    at::Tensor out = at::zeros({position_.size(0), SolvedColumn::kCount}, position_.options());
    out.index_copy_(
        0, dark,
        at::cat({sides.sum(1), bounced.sum(1), sides.select(1, 1), bounced.select(1, 1)}, 1));
    return out;
  }

 private:
  /// Receivers at a time: their links are 64 MB at 512 senders.
  static constexpr int64_t kBlock = 8192;

  static std::span<const Vec3> triples(const at::Tensor& t) {
    return {reinterpret_cast<const Vec3*>(t.const_data_ptr<float>()),
            static_cast<size_t>(t.size(0))};
  }
  radiosity::Points host_points() const {
    return {triples(host_.position), triples(host_.normal), triples(host_.albedo),
            triples(host_.emission),
            std::span(host_.area.const_data_ptr<float>(), static_cast<size_t>(host_.area.size(0)))};
  }
  template <typename T>
  at::Tensor on_device(const std::vector<T>& values, at::ScalarType type) const {
    at::Tensor host = at::empty({static_cast<int64_t>(values.size())}, type);
    std::copy(values.begin(), values.end(), host.template data_ptr<T>());
    return host.to(device_);
  }
  at::Tensor rows_of(const std::vector<size_t>& rows) const {
    return on_device(std::vector<int64_t>(rows.begin(), rows.end()), at::kLong);
  }

  void lay_out() {
    const radiosity::MarkedGrid& marked = layout_.grid().marked();
    std::vector<float> surfels, middles;
    for (const radiosity::Surfel& s : marked.surfels) {
      for (const Vec3& v : {s.middle, s.normal}) surfels.insert(surfels.end(), {v.x, v.y, v.z});
    }
    std::vector<int64_t> begins = {0};
    for (const radiosity::Cluster& cluster : layout_.clusters()) {
      begins.push_back(static_cast<int64_t>(cluster.last));
      middles.insert(middles.end(), {cluster.middle.x, cluster.middle.y, cluster.middle.z});
    }
    surfels_ = on_device(surfels, at::kFloat);
    clearance_ = on_device(marked.clearance, at::kInt);
    middle_ = on_device(middles, at::kFloat);
    cluster_ = on_device(begins, at::kLong);
    luminaire_ = rows_of(layout_.luminaires());
    view_ = {position_.const_data_ptr<float>(),
             normal_.const_data_ptr<float>(),
             emission_.const_data_ptr<float>(),
             area_.const_data_ptr<float>(),
             luminaire_.const_data_ptr<int64_t>(),
             cluster_.const_data_ptr<int64_t>(),
             middle_.const_data_ptr<float>(),
             static_cast<int64_t>(layout_.clusters().size()),
             {clearance_.const_data_ptr<int32_t>(),
              surfels_.const_data_ptr<float>(),
              {marked.shape.low.x, marked.shape.low.y, marked.shape.low.z},
              marked.shape.cell,
              marked.shape.inverse,
              {marked.shape.size[0], marked.shape.size[1], marked.shape.size[2]}}};
  }

  /// @param direct  [D, 6] of the dark points
  void choose_senders(const at::Tensor& direct) {
    const at::Tensor host = direct.cpu();
    const auto* light = host.const_data_ptr<float>();
    std::vector<radiosity::Sides> sides(static_cast<size_t>(position_.size(0)));
    std::vector<int64_t> place(sides.size());
    for (size_t k = 0; k < layout_.dark().size(); ++k) {
      const float* of = light + 6 * k;
      sides[layout_.dark()[k]] = {Rgb{of[0], of[1], of[2]}, Rgb{of[3], of[4], of[5]}};
      place[layout_.dark()[k]] = static_cast<int64_t>(k);
    }
    const auto wanted = static_cast<size_t>(radiosity::Options().senders);
    std::vector<int64_t> rows, among_dark;
    std::vector<float> areas;
    for (const radiosity::Sender& sender : layout_.choose_senders(sides, 1, wanted)) {
      rows.push_back(static_cast<int64_t>(sender.point));
      among_dark.push_back(place[sender.point]);
      areas.push_back(sender.area);
    }
    sender_ = on_device(rows, at::kLong);
    sender_dark_ = on_device(among_dark, at::kLong);
    sender_area_ = on_device(areas, at::kFloat);
  }

  /// [R, 2, 3] of rows [R].
  at::Tensor received(const at::Tensor& rows, const at::Tensor& radiosity) const {
    return times(links_to(rows), radiosity);
  }
  static at::Tensor times(const at::Tensor& links, const at::Tensor& radiosity) {
    const int64_t R = links.size(0), columns = links.size(2);
    return at::mm(links.view({2 * R, columns}), radiosity).view({R, 2, 3});
  }

  at::Tensor links_to(const at::Tensor& rows) const {
    const int64_t R = rows.size(0), S = sender_.size(0);
    at::Tensor links = at::zeros({R, 2, 2 * S}, position_.options());
    if (R == 0 || S == 0) return links;
    kernels_.links(view_, rows, sender_, sender_area_, links);
    // What areas overlap is taken off: a side gets at most what a full hemisphere gives.
    return links.div_(links.sum(2, /*keepdim=*/true).clamp_min(1));
  }

  /// Radiosity of the senders after all but the last reflection, [2 S, 3].
  at::Tensor bounce(const at::Tensor& direct) const {
    const int64_t S = sender_.size(0);
    const at::Tensor own = direct.index_select(0, sender_dark_).view({S, 2, 3});
    const at::Tensor albedo = albedo_.index_select(0, sender_).unsqueeze(1);
    const at::Tensor links = links_to(sender_);
    at::Tensor radiosity = at::zeros({2 * S, 3}, position_.options());
    for (int i = 0; i < radiosity::Options().bounces; ++i) {
      const at::Tensor reflected = own.add(times(links, radiosity)).mul(albedo);
      radiosity = reflected.transpose(0, 1).reshape({2 * S, 3});
    }
    return radiosity;
  }

  c10::Device device_;
  at::Tensor position_, normal_, albedo_, emission_, area_;
  SurfaceTensors host_;
  radiosity::Layout layout_;
  const Kernels& kernels_;
  at::Tensor surfels_, clearance_, middle_, cluster_, luminaire_;
  at::Tensor sender_, sender_dark_, sender_area_;
  LitView view_{};
};

}  // namespace lte::ops
