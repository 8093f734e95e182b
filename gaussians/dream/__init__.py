"""Objects from words or a picture, by score distillation (Poole et al. 2022, "DreamFusion").

    start (sphere, asset, mesh) -> a random view -> drawn -> noised -> a denoiser's opinion -> gradient -> step

`dreaming.dream` is the loop, `sds` the gradient, `views` draws the views, `start` makes the first Gaussians, `prior`
reads the prompt, and `denoisers` holds what knows pictures.
"""
