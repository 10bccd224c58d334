// SPDX-License-Identifier: MIT
using UnrealBuildTool;

public class SpherechainEditor : ModuleRules
{
	public SpherechainEditor(ReadOnlyTargetRules Target) : base(Target)
	{
		PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
		PublicDependencyModuleNames.AddRange(new string[] { "Core", "CoreUObject", "Engine", "AnimGraph", "Spherechain" });
		PrivateDependencyModuleNames.AddRange(new string[] { "BlueprintGraph" });
	}
}
