"""What is modelled: the scene, its pre-stress, what it records, and the step that it allows. Imports nothing else."""
