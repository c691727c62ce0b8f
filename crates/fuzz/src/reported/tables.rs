//! Small tables as the program writes them, which reports and gates read beside those of a campaign and a simulation that are made.

/// What is wrong with an engine from outside.
pub(super) const DIAGNOSIS: &str = r#"engine,verdict,hypothesis,sentence,answers,differing,all_differing,contradicted,agreeing,example
mine,explains,tolerance,"with a search distance of 1/10, not 1/8",3,5,7,0,20,cases/v-f-engine-missing.toml
mine,contradicted,order,with its blocks exchanged,1,5,7,2,20,
mine,unexplained,,,2,5,7,0,20,edge_cross 3 auto
"#;

/// What engines from outside were put through.
pub(super) const ENGINES: &str = r#"engine,asked,processes_started,recovered,not_compared
mine,64,2,1,3
other,64,1,0,0
"#;

/// Steps of stepper and exact side: the same, others, one that failed.
pub(super) const LOCKSTEP: &str = r#"step,time_s,contacts_stepper,contacts_oracle,contacts_differ,modes_differ,first_mode_difference,iterations_stepper,iterations_oracle,converged_stepper,converged_oracle,retries_stepper,retries_oracle,time_step_stepper_s,time_step_oracle_s,displacement_error,worst_block,penetration_stepper_m,penetration_oracle_m,undecided,tolerance,representation,arithmetic,defect,effect,penetration_contacts_m,penetration_modes_m,failure,velocity_error,anchor_error_m
2,0.02,4,4,0,0,,3,3,true,true,,,0.01,0.01,6.118960517724611e-13,1,9.556839964325325e-5,9.556839964323822e-5,0,2,0,0,0,,,,,2.475831622345127e-16,2.1984634703787368e-16
3,0.03,4,4,0,0,,3,3,true,true,,,0.01,0.01,3.5617479418860906e-13,1,6.874939965550997e-5,6.87493996554797e-5,0,3,0,0,0,,,,,7.169867082783311e-16,1.246584975766606e-16
4,0.04,4,4,1,1,1,4,3,true,true,,,0.01,0.01,3.5617479418860906e-13,1,6.874939965550997e-5,6.87493996554797e-5,0,3,0,1,0,contacts,6.8e-5,6.8e-5,,7.169867082783311e-16,1.246584975766606e-16
5,0.04,4,4,1,1,1,,,true,true,,,0.01,0.01,3.5617479418860906e-13,1,6.874939965550997e-5,6.87493996554797e-5,0,3,0,1,0,,6.8e-5,6.8e-5,the system of block 2 cannot be solved,7.169867082783311e-16,1.246584975766606e-16
"#;

/// How they differ.
pub(super) const DIFFERENCES: &str = r#"step,time_s,cause,change,block_a,block_b,kind,feature_a,feature_b,solve,before,after,predicate,features,margin,margin_ulps,unsettled,state
2,0.02,tolerance,extra,0,1,f-v,1,1,,,f-v 1/1 by f-v 1/1 overlap,cone-passes,B.v1 A.f1 B.e0,-2.162476057876569e-11,,,step_000002.json
2,0.02,tolerance,extra,0,1,f-v,1,2,,,f-v 1/2 by f-v 1/2 overlap,cone-passes,B.v2 A.f1 B.e5,-1.6874036297733663e-11,,,step_000002.json
3,0.03,tolerance,extra,0,1,f-v,1,1,,,f-v 1/1 by f-v 1/1 overlap,cone-passes,B.v1 A.f1 B.e0,-5.46969518494795e-11,,,step_000003.json
3,0.03,tolerance,extra,0,1,f-v,1,2,,,f-v 1/2 by f-v 1/2 overlap,cone-passes,B.v2 A.f1 B.e5,-4.26804699126671e-11,,,step_000003.json
3,0.03,tolerance,iterations,,,,,,,4,3,,,,,,step_000003.json
"#;

/// Pairs more and more extreme.
pub(super) const STRESS: &str = r#"axis,level,form,tolerances,engine,pairs,representation,arithmetic,lost,differ,share,low,high
offset,0,aligned,auto,stepper-f32,16,0,1,0,1,0.062500,0.011119,0.283287
offset,0,aligned,auto,stepper-f64,16,0,0,0,0,0.000000,0.000000,0.193608
offset,0,generic,auto,stepper-f32,16,0,0,0,0,0.000000,0.000000,0.193608
offset,0,generic,auto,stepper-f64,16,0,0,0,0,0.000000,0.000000,0.193608
offset,1e6,aligned,auto,stepper-f32,16,11,4,1,13,0.812500,0.569911,0.934084
offset,1e6,aligned,auto,stepper-f64,16,0,4,0,4,0.250000,0.101821,0.494983
offset,1e6,generic,auto,stepper-f32,16,6,2,7,13,0.812500,0.569911,0.934084
offset,1e6,generic,auto,stepper-f64,16,0,0,0,0,0.000000,0.000000,0.193608
"#;

/// How far an engine agrees there.
pub(super) const LIMITS: &str = r#"axis,form,tolerances,engine,clean_to,safe_to,pairs_to_safe,differ_to_safe,high_to_safe,beyond,share_beyond
offset,aligned,auto,stepper-f32,,,0,0,,0,0.062500
offset,aligned,auto,stepper-f64,0,,0,0,,0,0.000000
offset,generic,auto,stepper-f32,1e1,,0,0,,0,0.000000
offset,generic,auto,stepper-f64,1e8,,0,0,,0,0.000000
"#;

/// Steps against closed forms; one stopped.
pub(super) const STEPS: &str = r#"case,motion,engine,level,overlap_m,expected_m,relative_error,drift_m,unconverged,stopped
rest,rigid,stepper-f32,1,6.500e-5,6.500e-5,1.746e-5,0.000e0,0,
rest,rigid,stepper-f32,10,6.500e-5,6.500e-5,1.746e-5,0.000e0,0,
contrast,rigid,stepper-f32,1,6.497e-5,6.500e-5,4.760e-4,0.000e0,0,
contrast,rigid,stepper-f64,1,6.500e-5,6.500e-5,2.809e-13,0.000e0,0,
contrast,rigid,stepper-f32,100000000,,6.500e-13,,,0,settling step -19 (the last is 0): the system of block 2 cannot be solved: a pivot is not positive
"#;

/// Run time against error; one run stopped.
pub(super) const BENCH: &str = r#"kind,subject,engine,tolerances,time_step_s,units,us_per_unit,error,error_of,front,note
scene,free_fall,stepper-f32,scene,4.0000e-2,7,3.5410e0,2.1622e-7,displacement,1,
scene,free_fall,stepper-f32,scene,1.0000e-2,25,3.4243e0,3.3379e-7,displacement,1,
scene,free_fall,stepper-f32,scene,2.5000e-3,100,3.4273e0,5.4836e-7,displacement,0,
scene,rest_on_floor,stepper-f32,scene,1.0000e-2,,,,displacement,,the system of block 2 cannot be solved
"#;
