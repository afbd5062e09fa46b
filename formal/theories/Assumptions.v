(** The headline theorems: what each of them assumes. *)
From Ratt Require Import Teams Guarantees Planner Greedy GroupSize GroupSizeComplete Families Approached Quadratic Criteria Certificate Examples.

Print Assumptions ratt_bait_or_greedy.
Print Assumptions submodular_guarantee.
Print Assumptions non_decreasing_guarantee.
Print Assumptions ratt_submodular.
Print Assumptions ratt_non_decreasing.
Print Assumptions greedy_submodular.
Print Assumptions greedy_total_curvature.
Print Assumptions group_size_submodular_any.
Print Assumptions group_size_total_curvature_any.
Print Assumptions ratt_optimal_any.
Print Assumptions group_size_submodular_unsplit.
Print Assumptions group_size_total_curvature_unsplit.
Print Assumptions group_size_submodular.
Print Assumptions group_size_total_curvature.
Print Assumptions ratt_optimal.
Print Assumptions one_minus_k_attained.
Print Assumptions one_minus_c_squared_family.
Print Assumptions one_minus_c_squared_approached.
Print Assumptions trace_fenchel.
Print Assumptions trace_fenchel_tight.
Print Assumptions largest_eigenvalue_fenchel.
Print Assumptions trace_value0.
Print Assumptions trace_value_mono.
Print Assumptions maxeig_value0.
Print Assumptions maxeig_value_mono.
Print Assumptions certificate_upper.
Print Assumptions certificate_sound.
Print Assumptions trace_certificate_sound.
Print Assumptions certificate_bracket.
Print Assumptions relay_exact.
Print Assumptions relay_groups.
Print Assumptions safe_exact.
Print Assumptions safe_groups.
Print Assumptions split_exact.
Print Assumptions split_groups.
