// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/shortest_loop.h"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

namespace spherechain::baker {
namespace {

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using Graph = boost::adjacency_list<
    boost::vecS, boost::vecS, boost::directedS,
    boost::property<
        boost::vertex_index_t, std::size_t,
        boost::property<boost::vertex_color_t, boost::default_color_type,
                        boost::property<boost::vertex_distance_t, long,
                                        boost::property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>>,
    boost::property<boost::edge_capacity_t, double,
                    boost::property<boost::edge_residual_capacity_t, double,
                                    boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;

void connect(Graph& graph, std::size_t a, std::size_t b, double forth, double back) {
  const auto there = boost::add_edge(a, b, graph).first, home = boost::add_edge(b, a, graph).first;
  boost::put(boost::edge_capacity, graph, there, forth);
  boost::put(boost::edge_capacity, graph, home, back);
  boost::put(boost::edge_reverse, graph, there, home);
  boost::put(boost::edge_reverse, graph, home, there);
}

}  // namespace

void shorten_loop(const Mesh& mesh, const std::vector<std::array<Index, 3>>& neighbours,
                  const std::vector<Index>& strip, std::uint8_t inner, std::uint8_t outer,
                  std::vector<std::uint8_t>& labels) {
  std::vector<Index> node(mesh.triangles.size(), kNoIndex);
  for (Index i = 0; i < strip.size(); ++i) node[strip[i]] = i;
  const std::size_t source = strip.size(), sink = source + 1;
  Graph graph(strip.size() + 2);
  for (const Index t : strip) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index n = neighbours[t][k];
      if (n == kNoIndex || (node[n] != kNoIndex && n < t)) continue;  // an inner edge once
      const Triangle& v = mesh.triangles[t];
      const double length = (mesh.positions[v[k]] - mesh.positions[v[(k + 1) % 3]]).norm();
      if (node[n] != kNoIndex) {
        connect(graph, node[t], node[n], length, length);
      } else if (labels[n] == inner) {
        connect(graph, source, node[t], length, 0);
      } else {
        connect(graph, node[t], sink, length, 0);
      }
    }
  }
  boost::boykov_kolmogorov_max_flow(graph, source, sink);
  // The vertices that the source still reaches are the smallest inner side of all minimum cuts.
  const auto residual = boost::get(boost::edge_residual_capacity, graph);
  std::vector<bool> reached(strip.size() + 2, false);
  std::vector<std::size_t> stack{source};
  reached[source] = true;
  while (!stack.empty()) {
    const std::size_t here = stack.back();
    stack.pop_back();
    for (const auto e : boost::make_iterator_range(boost::out_edges(here, graph))) {
      const std::size_t next = boost::target(e, graph);
      if (reached[next] || !(residual[e] > 0)) continue;
      reached[next] = true;
      stack.push_back(next);
    }
  }
  for (std::size_t i = 0; i < strip.size(); ++i) labels[strip[i]] = reached[i] ? inner : outer;
}

}  // namespace spherechain::baker
