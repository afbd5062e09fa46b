"""
The same team on six communication graphs
=========================================

Links cost nothing to plan with and much to lose. The worst-case value of the best plan under one blinded robot and two
cut links, for one scenario on six graphs.
"""

import networkx as nx
from matplotlib.figure import Figure

import ratt_opt as ro

team = ro.random_scenario(8, 6, alpha_s=1, alpha_c=2, seed=4)
graphs = {
    "line": nx.path_graph(8),
    "star": nx.star_graph(7),
    "ring": nx.cycle_graph(8),
    "grid": nx.convert_node_labels_to_integers(nx.grid_2d_graph(2, 4)),
    "ladder": nx.circular_ladder_graph(4),
    "complete": nx.complete_graph(8),
}
kept, groups = [], []
for graph in graphs.values():
    problem = team.replace(links=list(graph.edges)).problem()
    kept.append(ro.worst_case_attack(problem, ro.ratt(problem).elements).upper)
    groups.append(ro.smallest_largest_group(graph, 2).upper)

# %%
# The number in a bar is the size of the largest group that two cuts can leave.
figure = Figure(figsize=(7, 3.6), layout="constrained")
axes = figure.subplots()
bars = axes.bar(list(graphs), kept, color="#0b5394")
axes.bar_label(bars, groups, label_type="center", color="white")
axes.set_ylabel("RATT keeps [m²]")
axes.spines[["top", "right"]].set_visible(False)
assert kept[0] <= kept[-1]  # a line is worth no more than all links
